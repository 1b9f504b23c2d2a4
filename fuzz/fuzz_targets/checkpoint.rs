//! A checkpoint, as it is and with its head mended, for a small model.
#![no_main]

use std::sync::{Arc, LazyLock};

use fecontact::laws::bulk::{ElasticConstants, NeoHookean};
use fecontact::laws::friction::CoulombParameters;
use fecontact::mesh::InlineMesh;
use fecontact::model::Model;
use fecontact::model::builder::{Contact, LoadStep, Support};
use fecontact::output::checkpoint;
use fecontact::run::SavedRun;
use libfuzzer_sys::fuzz_target;

/// The model whose checkpoint is the seed.
static MODEL: LazyLock<Arc<Model>> = LazyLock::new(|| {
    let mesh = InlineMesh::default().rectangle("ground", [2, 1], [0.0, -1.0], [2.0, 0.0]);
    let mesh = mesh.rectangle("block", [1, 1], [0.5, 0.0], [1.5, 1.0]).build().expect("a mesh");
    let rubber = NeoHookean::new(&ElasticConstants { young: 1000.0, poisson: 0.3, density: 0.0 }).expect("constants");
    let step = LoadStep::new("press", 1.0).dt(0.5).fix("ground_bottom");
    let model = Model::builder(mesh).body("block", rubber).body("ground", rubber);
    let model = model.contact(Contact::new("base", "block_bottom", "ground_top", CoulombParameters::new(0.3)));
    let model = model.step(step.support(Support::on("block_top").ux(0.0).uy(-0.01)));
    Arc::new(model.build().expect("a model"))
});

fuzz_target!(|bytes: &[u8]| {
    const HEAD: usize = 37;
    let _ = checkpoint::from_bytes(bytes);
    let body = bytes.get(HEAD..).unwrap_or(bytes);
    let mut mended = b"fecontact checkpoint\n".to_vec();
    mended.extend_from_slice(&checkpoint::VERSION.to_le_bytes());
    mended.extend_from_slice(&(body.len() as u64).to_le_bytes());
    mended.extend_from_slice(&crc32fast::hash(body).to_le_bytes());
    mended.extend_from_slice(body);
    if let Ok(checkpoint) = checkpoint::from_bytes(&mended) {
        let _ = SavedRun::from_bytes(checkpoint.run, &MODEL);
    }
});
