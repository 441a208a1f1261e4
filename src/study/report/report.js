'use strict';
// The page can be read without any of this. Here it gets its switches: colours,
// hovering over plots, hiding curves, choosing pictures, the slider.
(() => {
  const root = document.documentElement;
  root.classList.add('scripted');
  const all = (where, what) => [...where.querySelectorAll(what)];
  const within = (value, low, high) => Math.min(Math.max(value, low), high);

  // Colours. Where nothing can be remembered, the choice lasts as long as the page.
  const buttons = all(document, '.theme button');
  const colour = (theme) => {
    if (theme) root.dataset.theme = theme; else delete root.dataset.theme;
    buttons.forEach((b) => b.setAttribute('aria-pressed', b.dataset.theme === theme));
  };
  const KEY = 'nephroid-report-theme';
  try { colour(localStorage.getItem(KEY) || ''); } catch { colour(''); }
  buttons.forEach((b) => b.addEventListener('click', () => {
    colour(b.dataset.theme);
    try { localStorage.setItem(KEY, b.dataset.theme); } catch { /* it lasts as long as the page */ }
  }));

  // Plots. A dot's words come from its title, which would show beside ours.
  const readDots = (svg) => all(svg, '.dot').map((node) => {
    const [x, y] = node.getAttribute('transform').match(/-?[\d.]+/g).map(Number);
    const title = node.querySelector('title');
    title.remove();
    return { node, x, y, words: title.textContent, group: node.closest('[data-s]') };
  });

  for (const stage of all(document, '.stage')) {
    const plots = all(stage, 'svg').map((svg) => ({ svg, dots: readDots(svg) }));
    const tip = document.createElement('div');
    tip.className = 'tip';
    tip.setAttribute('role', 'status');
    stage.append(tip);
    stage.tabIndex = 0;
    stage.setAttribute('role', 'group');
    stage.setAttribute('aria-label', 'Plot; arrow keys walk from point to point');
    let current = null;
    const plot = () => plots.find((p) => p.svg.getClientRects().length) || plots[0];
    const seen = () => plot().dots.filter((d) => !d.group.classList.contains('off'));
    const scale = (svg) => svg.getBoundingClientRect().width / svg.viewBox.baseVal.width;

    const show = (dot) => {
      if (current) current.node.classList.remove('here');
      current = dot;
      all(stage, '[data-s]').forEach((g) => {
        g.classList.toggle('dim', !!dot && g.dataset.s !== dot.group.dataset.s);
      });
      tip.textContent = dot ? dot.words : '';
      if (!dot) return;
      dot.node.classList.add('here');
      const { svg } = plot();
      const box = svg.getBoundingClientRect();
      const [x, y] = [dot.x * scale(svg), dot.y * scale(svg)];
      tip.style.left = '0px';
      const [width, height] = [tip.offsetWidth, tip.offsetHeight];
      tip.style.left = `${within(x + 12, 0, Math.max(box.width - width, 0))}px`;
      tip.style.top = `${y - height - 12 < 0 ? y + 14 : y - height - 12}px`;
    };

    const REACH = 28;
    const nearest = (event) => {
      const { svg } = plot();
      const box = svg.getBoundingClientRect();
      const s = scale(svg);
      let [best, least] = [null, REACH];
      for (const dot of seen()) {
        const far = Math.hypot(dot.x * s - event.clientX + box.left, dot.y * s - event.clientY + box.top);
        if (far < least) [best, least] = [dot, far];
      }
      return best;
    };
    const point = (event) => {
      const dot = nearest(event);
      if (dot !== current) show(dot);
    };
    stage.addEventListener('pointermove', point);
    stage.addEventListener('pointerdown', point);
    stage.addEventListener('pointerleave', (event) => { if (event.pointerType === 'mouse') show(null); });
    stage.addEventListener('blur', () => show(null));
    stage.addEventListener('keydown', (event) => {
      const dots = seen();
      if (!dots.length) return;
      const groups = [...new Set(dots.map((d) => d.group))];
      const held = dots.includes(current) ? current : null;
      const own = dots.filter((d) => d.group === (held ? held.group : groups[0]));
      const at = own.indexOf(held);
      const other = (step) => {
        const place = (groups.indexOf(held.group) + step + groups.length) % groups.length;
        const theirs = dots.filter((d) => d.group === groups[place]);
        const far = (d) => Math.abs(d.x - held.x);
        return theirs.reduce((a, b) => (far(b) < far(a) ? b : a));
      };
      const moves = {
        ArrowRight: () => own[Math.min(at + 1, own.length - 1)],
        ArrowLeft: () => own[Math.max(at - 1, 0)],
        ArrowUp: () => (held ? other(-1) : own[0]),
        ArrowDown: () => (held ? other(1) : own[0]),
        Home: () => own[0],
        End: () => own[own.length - 1],
        Escape: () => null,
      };
      if (!Object.hasOwn(moves, event.key)) return;
      event.preventDefault();
      show(moves[event.key]());
    });
  }

  for (const box of all(document, '.legend input')) {
    const turn = () => {
      const groups = all(box.closest('.chart'), `.stage [data-s="${box.dataset.s}"]`);
      groups.forEach((g) => g.classList.toggle('off', !box.checked));
    };
    box.addEventListener('change', turn);
    turn();
  }

  // Strips show one level at a time.
  for (const strips of all(document, '.strips')) {
    const rows = all(strips, '.row');
    const choice = all(strips, '.choice button');
    const choose = (index) => {
      rows.forEach((row, i) => { row.hidden = i !== index; });
      choice.forEach((b, i) => b.setAttribute('aria-pressed', i === index));
    };
    choice.forEach((b, i) => b.addEventListener('click', () => choose(i)));
    choose(Number(strips.dataset.first));
  }

  // The slider. A view is a zoom about a centre, in pixels of the picture.
  const MOST = 32;
  for (const viewer of all(document, '.viewer')) {
    const [width, height] = [Number(viewer.dataset.width), Number(viewer.dataset.height)];
    const panes = viewer.querySelector('.panes');
    const [left, right] = ['.left', '.right'].map((side) => panes.querySelector(side));
    const border = panes.querySelector('.border');
    const range = viewer.querySelector('input');
    const said = viewer.querySelector('output');
    const view = { zoom: 1, x: width / 2, y: height / 2 };
    panes.tabIndex = 0;
    panes.setAttribute('role', 'group');
    panes.setAttribute('aria-label', 'Two pictures; plus and minus enlarge, arrow keys move them');

    const split = () => {
      right.style.clipPath = `inset(0 0 0 ${range.value}%)`;
      border.style.left = `${range.value}%`;
      range.setAttribute('aria-valuetext', `${Math.round(range.value)} % of the left picture`);
    };
    const draw = () => {
      const [w, h] = [width / view.zoom, height / view.zoom];
      view.x = within(view.x, w / 2, width - w / 2);
      view.y = within(view.y, h / 2, height - h / 2);
      [left, right].forEach((svg) => svg.setAttribute('viewBox', `${view.x - w / 2} ${view.y - h / 2} ${w} ${h}`));
      panes.classList.toggle('large', view.zoom > 1);
      said.textContent = `${view.zoom}×`;
    };
    // The picture's point at the place of an event.
    const under = (event) => {
      const box = panes.getBoundingClientRect();
      return [
        view.x + ((event.clientX - box.left) / box.width - 0.5) * (width / view.zoom),
        view.y + ((event.clientY - box.top) / box.height - 0.5) * (height / view.zoom),
      ];
    };
    const zoom = (step, about) => {
      const next = step ? within(view.zoom * 2 ** step, 1, MOST) : 1;
      if (about) {
        const share = 1 - view.zoom / next;
        view.x += (about[0] - view.x) * share;
        view.y += (about[1] - view.y) * share;
      }
      view.zoom = next;
      draw();
    };

    let drag = null;
    panes.addEventListener('pointerdown', (event) => {
      const box = panes.getBoundingClientRect();
      const place = box.left + box.width * range.value / 100;
      const moves = view.zoom > 1 && Math.abs(event.clientX - place) > 24;
      drag = { moves, from: under(event) };
      try { panes.setPointerCapture(event.pointerId); } catch { /* a pointer that has gone */ }
      if (!moves) slide(event);
    });
    const slide = (event) => {
      const box = panes.getBoundingClientRect();
      range.value = within((event.clientX - box.left) / box.width * 100, 0, 100);
      split();
    };
    panes.addEventListener('pointermove', (event) => {
      if (!drag) return;
      if (!drag.moves) { slide(event); return; }
      const [x, y] = under(event);
      view.x += drag.from[0] - x;
      view.y += drag.from[1] - y;
      draw();
    });
    const drop = () => { drag = null; };
    panes.addEventListener('pointerup', drop);
    panes.addEventListener('pointercancel', drop);
    panes.addEventListener('dblclick', (event) => zoom(1, under(event)));
    panes.addEventListener('keydown', (event) => {
      const step = 0.1 / view.zoom;
      const moves = {
        ArrowLeft: () => { view.x -= width * step; },
        ArrowRight: () => { view.x += width * step; },
        ArrowUp: () => { view.y -= height * step; },
        ArrowDown: () => { view.y += height * step; },
        '+': () => zoom(1),
        '-': () => zoom(-1),
        0: () => zoom(0),
      };
      if (!Object.hasOwn(moves, event.key) || event.ctrlKey || event.metaKey) return;
      event.preventDefault();
      moves[event.key]();
      draw();
    });
    range.addEventListener('input', split);
    const steps = { in: 1, out: -1, all: 0 };
    all(viewer, '[data-zoom]').forEach((b) => b.addEventListener('click', () => zoom(steps[b.dataset.zoom])));
    const sides = { left, right };
    all(viewer, 'select').forEach((select) => {
      const pick = () => sides[select.dataset.side].firstElementChild.setAttribute('href', `#${select.value}`);
      select.addEventListener('change', pick);
      pick();
    });
    const scene = viewer.closest('section');
    all(scene, '.pick').forEach((b) => b.addEventListener('click', () => {
      const select = viewer.querySelector('[data-side=left]');
      select.value = b.dataset.pick;
      select.dispatchEvent(new Event('change'));
      viewer.scrollIntoView({ block: 'nearest' });
      range.focus({ preventScroll: true });
    }));
    split();
    draw();
  }
})();
