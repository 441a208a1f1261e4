//! A headless Chromium and what it is told: the `DevTools` protocol over a pipe,
//! messages of JSON that end with a zero byte.

use std::{
    env,
    io::{BufRead, BufReader, Write},
    path::{Path, PathBuf},
    process::{Child, ChildStdin, Command, Stdio},
    sync::mpsc::{Receiver, channel},
    thread,
    time::Duration,
};

use serde_json::{Value, json};
use tempfile::TempDir;

/// A browser with one page. It ends with the test.
pub(crate) struct Browser {
    child: Child,
    orders: Option<ChildStdin>,
    answers: Receiver<Value>,
    session: Option<String>,
    sent: u64,
    /// Events that have arrived since [`Browser::open`].
    events: Vec<Value>,
    _profile: TempDir,
}

/// Where Chromium is: what the variable `CHROME` names, or the first of the
/// usual names on the path.
pub(crate) fn find() -> Option<PathBuf> {
    if let Some(named) = env::var_os("CHROME").filter(|named| !named.is_empty()) {
        return Some(named.into());
    }
    let names = ["chromium", "chromium-browser", "google-chrome"];
    let paths = env::var_os("PATH")?;
    let places = env::split_paths(&paths).flat_map(|p| names.map(|name| p.join(name)));
    places.into_iter().find(|place| place.is_file())
}

impl Browser {
    /// Starts `program` with a profile of its own.
    pub(crate) fn start(program: &Path) -> Self {
        let profile = tempfile::tempdir().unwrap();
        // The protocol uses descriptors 3 and 4, which the shell joins to the
        // ends of the pipes.
        let mut child = Command::new("sh")
            .args(["-c", "exec \"$0\" \"$@\" 3<&0 4>&1 </dev/null >/dev/null"])
            .arg(program)
            .args([
                "--headless",
                "--remote-debugging-pipe",
                "--no-sandbox",
                "--disable-gpu",
                "--disable-quic",
                "--disable-dev-shm-usage",
                "--no-first-run",
                "--disable-background-networking",
                "--disable-component-update",
                "--disable-sync",
                "--hide-scrollbars",
            ])
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let (send, answers) = channel();
        let mut output = BufReader::new(child.stdout.take().unwrap());
        thread::spawn(move || {
            let mut message = Vec::new();
            while output
                .read_until(0, &mut message)
                .is_ok_and(|length| length > 0)
            {
                message.pop();
                let value = serde_json::from_slice(&message);
                if value.is_ok_and(|value| send.send(value).is_err()) {
                    return;
                }
                message.clear();
            }
        });
        let mut browser = Self {
            orders: child.stdin.take(),
            child,
            answers,
            session: None,
            sent: 0,
            events: Vec::new(),
            _profile: profile,
        };
        let target = browser.call("Target.createTarget", &json!({"url": "about:blank"}));
        let attach = json!({"targetId": target["targetId"], "flatten": true});
        let session = browser.call("Target.attachToTarget", &attach);
        browser.session = session["sessionId"].as_str().map(str::to_owned);
        for domain in ["Page", "Runtime", "Log", "Network", "Accessibility"] {
            browser.call(&format!("{domain}.enable"), &json!({}));
        }
        browser
    }

    /// Says what to do and waits for what comes of it.
    pub(crate) fn call(&mut self, method: &str, with: &Value) -> Value {
        self.sent += 1;
        let mut message = json!({"id": self.sent, "method": method, "params": with});
        if let Some(session) = &self.session {
            message["sessionId"] = json!(session);
        }
        let mut bytes = message.to_string().into_bytes();
        bytes.push(0);
        let orders = self.orders.as_mut().unwrap();
        orders
            .write_all(&bytes)
            .and_then(|()| orders.flush())
            .unwrap();
        loop {
            let answer = self.receive(method);
            if answer["id"] == json!(self.sent) {
                assert!(answer["error"].is_null(), "{method}: {}", answer["error"]);
                return answer["result"].clone();
            }
            self.events.push(answer);
        }
    }

    fn receive(&self, during: &str) -> Value {
        // A browser that is starting on a busy machine may take a while; one
        // that says nothing for two minutes hangs.
        let patience = Duration::from_secs(120);
        let answer = self.answers.recv_timeout(patience);
        answer.unwrap_or_else(|_| panic!("the browser went silent: {during}"))
    }

    /// Opens a file and waits until it has loaded.
    pub(crate) fn open(&mut self, file: &Path) {
        self.events.clear();
        self.call(
            "Page.navigate",
            &json!({"url": format!("file://{}", file.display())}),
        );
        let loaded = |e: &Value| e["method"] == "Page.loadEventFired";
        while !self.events.iter().any(loaded) {
            let event = self.receive("loading");
            self.events.push(event);
        }
    }

    /// The value of an expression in the page.
    pub(crate) fn value(&mut self, expression: &str) -> Value {
        let with = json!({"expression": expression, "returnByValue": true, "awaitPromise": true});
        let found = self.call("Runtime.evaluate", &with);
        assert!(found["exceptionDetails"].is_null(), "{expression}: {found}");
        found["result"]["value"].clone()
    }

    /// The same as a number.
    pub(crate) fn number(&mut self, expression: &str) -> f64 {
        let value = self.value(expression);
        value
            .as_f64()
            .unwrap_or_else(|| panic!("{expression}: {value}"))
    }

    /// The same as text.
    pub(crate) fn text(&mut self, expression: &str) -> String {
        let value = self.value(expression);
        value
            .as_str()
            .unwrap_or_else(|| panic!("{expression}: {value}"))
            .to_owned()
    }

    /// Complaints since the page was opened: exceptions, errors and warnings of
    /// the console, and requests for anything but files and data.
    pub(crate) fn complaints(&mut self) -> Vec<Value> {
        // Whatever was on its way has arrived when a further order is answered.
        self.value("new Promise((done) => requestAnimationFrame(() => setTimeout(done, 0)))");
        let bad = |event: &&Value| {
            let with = &event["params"];
            match event["method"].as_str().unwrap_or_default() {
                "Runtime.exceptionThrown" | "Runtime.consoleAPICalled" | "Log.entryAdded" => true,
                "Network.requestWillBeSent" => {
                    let url = with["request"]["url"].as_str().unwrap_or_default();
                    !url.starts_with("file:") && !url.starts_with("data:")
                }
                _ => false,
            }
        };
        self.events.iter().filter(bad).cloned().collect()
    }

    /// A pointer's or finger's event at a point of the window.
    pub(crate) fn mouse(&mut self, kind: &str, [x, y]: [f64; 2]) {
        let pressed = if kind == "mouseMoved" { "none" } else { "left" };
        let with = json!({"type": kind, "x": x, "y": y, "button": pressed, "clickCount": 1});
        self.call("Input.dispatchMouseEvent", &with);
    }

    /// A whole click.
    pub(crate) fn click(&mut self, at: [f64; 2]) {
        for kind in ["mouseMoved", "mousePressed", "mouseReleased"] {
            self.mouse(kind, at);
        }
    }

    /// A finger's event; none touches when it ends.
    pub(crate) fn touch(&mut self, kind: &str, at: Option<[f64; 2]>) {
        let points: Vec<Value> = at.iter().map(|[x, y]| json!({"x": x, "y": y})).collect();
        let with = json!({"type": kind, "touchPoints": points});
        self.call("Input.dispatchTouchEvent", &with);
    }

    /// A key, pressed and let go.
    pub(crate) fn key(&mut self, key: &str) {
        let code = match key {
            "ArrowLeft" => 37,
            "ArrowUp" => 38,
            "ArrowRight" => 39,
            "ArrowDown" => 40,
            "Escape" => 27,
            "End" => 35,
            _ => 0,
        };
        for kind in ["keyDown", "keyUp"] {
            let with =
                json!({"type": kind, "key": key, "code": key, "windowsVirtualKeyCode": code});
            self.call("Input.dispatchKeyEvent", &with);
        }
    }

    /// The middle of an element, scrolled into the window.
    pub(crate) fn middle(&mut self, selector: &str) -> [f64; 2] {
        let found = self.value(&format!(
            "(() => {{ const e = document.querySelector('{selector}'); \
             e.scrollIntoView({{block: 'center', behavior: 'instant'}}); \
             const b = e.getBoundingClientRect(); \
             return [b.left + b.width / 2, b.top + b.height / 2]; }})()"
        ));
        [0, 1].map(|k| found[k].as_f64().unwrap_or_else(|| panic!("no {selector}")))
    }

    /// The window as a screen of that size.
    pub(crate) fn screen(&mut self, width: u32, height: u32, phone: bool) {
        let with =
            json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": phone});
        self.call("Emulation.setDeviceMetricsOverride", &with);
        self.call(
            "Emulation.setTouchEmulationEnabled",
            &json!({"enabled": phone}),
        );
    }

    /// The reader's taste in colours, and whether the page is printed.
    pub(crate) fn taste(&mut self, scheme: &str, medium: &str) {
        // What scrolls by and by would be hit where it no longer is.
        let features = json!([
            {"name": "prefers-color-scheme", "value": scheme},
            {"name": "prefers-reduced-motion", "value": "reduce"},
        ]);
        let with = json!({"media": medium, "features": features});
        self.call("Emulation.setEmulatedMedia", &with);
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // It ends when its orders do; if not, it is made to.
        drop(self.orders.take());
        for _ in 0..50 {
            if matches!(self.child.try_wait(), Ok(Some(_))) {
                return;
            }
            thread::sleep(Duration::from_millis(100));
        }
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
