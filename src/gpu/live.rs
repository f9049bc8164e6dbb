//! Pipelines that follow their shaders while the program runs.

use super::{Gpu, GpuError, shader};
use std::collections::BTreeMap;
use std::fmt;
use std::hash::{BuildHasher, BuildHasherDefault, DefaultHasher};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// How often shaders have changed since the device was opened, and which of the changes do not compile.
#[derive(Debug, Default)]
pub(super) struct ShaderChanges {
    count: AtomicU64,
    /// By pipeline.
    failures: Mutex<BTreeMap<u64, GpuError>>,
    pipelines: AtomicU64,
}

impl Gpu {
    /// Has every pipeline look for another text of its shader the next time it is used. One whose new text does not compile stays as it is,
    /// see [`Gpu::shader_failures`].
    pub fn shaders_changed(&self) {
        self.shader_changes.count.fetch_add(1, Ordering::Relaxed);
    }

    /// Why shaders that changed are still used as they were, each message once.
    pub fn shader_failures(&self) -> Vec<String> {
        let mut all: Vec<String> =
            lock(&self.shader_changes.failures).values().map(GpuError::to_string).collect();
        all.sort_unstable();
        all.dedup();
        all
    }
}

/// Makes the pipeline from the compiled shader.
type Make<P> = Box<dyn Fn(&Gpu, &wgpu::ShaderModule) -> Result<P, GpuError> + Send + Sync>;

/// A pipeline, and what it takes to make it again.
pub(super) struct Live<P> {
    name: &'static str,
    generated: Vec<(String, String)>,
    make: Make<P>,
    made: Mutex<Made<P>>,
    changes: Arc<ShaderChanges>,
    /// Of this pipeline among those of the device.
    number: u64,
}

struct Made<P> {
    /// How often shaders had changed when their text was last looked at.
    looked: u64,
    /// The text that the pipeline is made from, and the one that was tried last.
    text: u64,
    tried: u64,
    pipeline: P,
}

impl<P: Clone> Live<P> {
    /// Compiles the shader and makes the pipeline.
    pub fn new(
        gpu: &Gpu,
        name: &'static str,
        generated: &[(&str, String)],
        make: Make<P>,
    ) -> Result<Self, GpuError> {
        let changes = gpu.shader_changes.clone();
        let looked = changes.count.load(Ordering::Relaxed);
        let expanded = shader::Expanded::new(name, generated)?;
        let text = hash(&expanded);
        let pipeline = make(gpu, &shader::compile(gpu, name, &expanded)?)?;
        Ok(Self {
            name,
            generated: generated.iter().map(|(name, text)| ((*name).to_owned(), text.clone())).collect(),
            make,
            made: Mutex::new(Made { looked, text, tried: text, pipeline }),
            number: changes.pipelines.fetch_add(1, Ordering::Relaxed),
            changes,
        })
    }

    /// The pipeline of the shader's present text, or of the last one that compiled.
    pub fn current(&self, gpu: &Gpu) -> P {
        let mut made = lock(&self.made);
        let now = self.changes.count.load(Ordering::Relaxed);
        if made.looked != now {
            made.looked = now;
            self.follow(gpu, &mut made);
        }
        made.pipeline.clone()
    }

    /// The pipeline as it was last used.
    pub fn last(&self) -> P {
        lock(&self.made).pipeline.clone()
    }

    fn follow(&self, gpu: &Gpu, made: &mut Made<P>) {
        let generated: Vec<(&str, String)> =
            self.generated.iter().map(|(name, text)| (name.as_str(), text.clone())).collect();
        let expanded = shader::Expanded::new(self.name, &generated);
        let text = expanded.as_ref().ok().map(hash);
        if text == Some(made.text) {
            made.tried = made.text;
            lock(&self.changes.failures).remove(&self.number);
        } else if text.is_none() || text != Some(made.tried) {
            let remade = expanded.and_then(|expanded| {
                shader::compile(gpu, self.name, &expanded).and_then(|module| (self.make)(gpu, &module))
            });
            made.tried = text.unwrap_or(made.tried);
            match remade {
                Ok(pipeline) => {
                    made.text = made.tried;
                    made.pipeline = pipeline;
                    lock(&self.changes.failures).remove(&self.number);
                }
                Err(error) => {
                    log::warn!("{error}");
                    lock(&self.changes.failures).insert(self.number, error);
                }
            }
        }
    }
}

impl<P> Drop for Live<P> {
    fn drop(&mut self) {
        lock(&self.changes.failures).remove(&self.number);
    }
}

impl<P> fmt::Debug for Live<P> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Live").field("shader", &self.name).finish_non_exhaustive()
    }
}

fn hash(expanded: &shader::Expanded) -> u64 {
    BuildHasherDefault::<DefaultHasher>::new().hash_one(expanded.text())
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
