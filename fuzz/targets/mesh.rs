//! Mesh files: refused in one line, or a mesh whose cells have their nodes.
#![no_main]

use libfuzzer_sys::fuzz_target;
use stickslip::MemoryFiles;
use stickslip::mesh::{GmshMesh, Mesh, MeshSpec};

fuzz_target!(|data: &[u8]| {
    let files = MemoryFiles::new([("part.msh", data)]);
    let spec = MeshSpec::Gmsh(GmshMesh { file: "part.msh".to_owned(), scale: 1.0 });
    match Mesh::read(&spec, &files) {
        Ok(mesh) => {
            assert!(mesh.cell_nodes.iter().all(|n| (*n as usize) < mesh.nodes.len()));
            assert!(mesh.nodes.iter().flatten().all(|x| x.is_finite()));
            mesh.quality();
        }
        Err(error) => assert_eq!(error.to_string().lines().count(), 1),
    }
});
