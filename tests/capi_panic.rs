//! A panic inside the library poisons the simulator of the call and nothing else.
#![cfg(all(feature = "capi", feature = "panic-injection"))]
#![allow(unsafe_code)]

use std::ffi::CString;
use std::ptr::null_mut;
use stickslip::ErrorCode;
use stickslip::capi::*;

fn message() -> String {
    let mut buffer = [0_u8; 512];
    // SAFETY: the buffer is as long as said
    let length = unsafe { stickslip_last_error(buffer.as_mut_ptr().cast(), buffer.len()) };
    String::from_utf8_lossy(&buffer[..length.min(511)]).into_owned()
}

#[test]
fn a_panic_poisons_one_simulator_and_the_host_lives() {
    let text = stickslip::scene::example("kazmi2014").unwrap();
    let cells = [("mesh.cells".to_string(), "[8, 4]".to_string())];
    let scene = stickslip::Scene::with_overrides(text, "x", &cells).unwrap();
    let text = CString::new(scene.to_json()).unwrap();
    // SAFETY: handles are live where they are used
    unsafe {
        let mut model = null_mut();
        assert_eq!(stickslip_model_compile(text.as_ptr(), &mut model), 0);
        let (mut hit, mut other, mut copy) = (null_mut(), null_mut(), null_mut());
        assert_eq!(stickslip_new(model, &mut hit), 0);
        assert_eq!(stickslip_new(model, &mut other), 0);
        assert_eq!(stickslip_init(hit, 0.0), 0);
        assert_eq!(stickslip_init(other, 0.0), 0);
        let poisoned = ErrorCode::Poisoned as i32;
        assert_eq!(stickslip_inject_panic(hit), poisoned);
        assert!(message().contains("injected"), "{}", message());
        let mut time = 7.0;
        assert_eq!(stickslip_do_step(hit, 0.0, 0.03125), poisoned);
        assert!(message().contains("injected"), "{}", message());
        assert_eq!(stickslip_get_time(hit, &mut time), poisoned);
        assert_eq!(stickslip_reset(hit), poisoned);
        assert_eq!(stickslip_clone(hit, &mut copy), poisoned);
        assert!(copy.is_null());
        assert_eq!(time, 7.0);
        assert_eq!(stickslip_do_step(other, 0.0, 0.03125), 0);
        stickslip_free(hit);
        let mut another = null_mut();
        assert_eq!(stickslip_new(model, &mut another), 0);
        assert_eq!(stickslip_init(another, 0.0), 0);
        stickslip_free(another);
        stickslip_free(other);
        stickslip_model_free(model);
    }
}
