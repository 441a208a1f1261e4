//! What a study refuses.

use std::path::PathBuf;

use nephroid::{
    reference::Method,
    study::{Request, Source, Subject, Sweep, Way},
};

use crate::{files, glass, request, run, subject};

#[test]
fn what_does_not_fit_is_refused() {
    let scene = glass();
    let directory = tempfile::tempdir().unwrap();
    let fault = |subjects: &[Subject<'_>], request: &Request| {
        run(subjects, request, directory.path())
            .unwrap_err()
            .to_string()
    };
    let one = subject("glass", &scene, Source::Make);
    let good = request(2, 1, &[Way::Photons]);
    let large = Request {
        resolution: Some([1 << 20, 1 << 20]),
        ..good.clone()
    };
    assert!(fault(std::slice::from_ref(&one), &large).contains("--resolution"));
    assert!(fault(&[], &good).contains("no scene"));
    assert!(fault(&[one.clone(), one.clone()], &good).contains("two scenes"));
    let blind = Request {
        reference_method: Some(Method::LightNaive),
        ..good.clone()
    };
    assert!(fault(std::slice::from_ref(&one), &blind).contains("blurred"));
    let sweep = Request {
        methods: Some(vec![Way::Reference(Method::Path)]),
        sweeps: vec![Sweep::Radius(vec![1.0])],
        ..good
    };
    assert!(fault(&[one], &sweep).contains("photons"));
    assert_eq!(
        files(directory.path()),
        [] as [PathBuf; 0],
        "nothing was made"
    );
}
