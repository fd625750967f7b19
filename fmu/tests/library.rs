//! Which shared library the packager takes.

use stickslip::NoFiles;
use stickslip_fmu::{Options, PackageError, find_library, package};

/// A build for tests panics on request: it is found, and refused; any other is packed.
#[test]
fn a_library_that_panics_on_request_is_not_packed() {
    let library = find_library().expect("the library was built");
    let scene = stickslip::scene::example("seal").expect("an embedded scene");
    let is_test_build = cfg!(feature = "panic-injection");
    match (package(scene, &NoFiles, &Options::default()), is_test_build) {
        (Err(PackageError::TestLibrary(refused)), true) => assert_eq!(refused, library),
        (Ok(packed), false) => assert_eq!(packed.library, library),
        (outcome, _) => panic!("{:?}", outcome.map(|packed| packed.library)),
    }
}
