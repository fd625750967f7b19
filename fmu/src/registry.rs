//! The one global of this library: which instances live, and which compiled models they share.
//!
//! Why a global at all. An importer hands back raw pointers; only a list of the live ones tells a freed or foreign pointer
//! from an instance without reading memory that may not be ours. And 64 instances of one FMU are 64 independent calls of a
//! C function: nothing but the process connects them, so the compiled model they share must be found there. The list
//! holds no simulation state, and is empty (without memory) again when the last instance is freed.

use crate::component::Component;
use crate::fault::Outcome;
use std::sync::{Arc, PoisonError, RwLock, Weak};

struct Registry {
    /// Addresses of the live instances, sorted.
    instances: Vec<usize>,
    /// Number given to the last instance.
    last_serial: u64,
    /// Shared components by the hash of what they were made from.
    components: Vec<(u64, Weak<Component>)>,
}

static REGISTRY: RwLock<Registry> = RwLock::new(Registry {
    instances: Vec::new(),
    last_serial: 0,
    components: Vec::new(),
});

/// Whether an instance lives at this address.
pub fn is_live(address: usize) -> bool {
    let registry = REGISTRY.read().unwrap_or_else(PoisonError::into_inner);
    registry.instances.binary_search(&address).is_ok()
}

/// Enters an instance.
pub fn enter(address: usize) {
    let mut registry = REGISTRY.write().unwrap_or_else(PoisonError::into_inner);
    if let Err(at) = registry.instances.binary_search(&address) {
        registry.instances.insert(at, address);
    }
}

/// A number that no other instance of this process has or had.
pub fn serial() -> u64 {
    let mut registry = REGISTRY.write().unwrap_or_else(PoisonError::into_inner);
    registry.last_serial += 1;
    registry.last_serial
}

/// Strikes an instance out; false when there is none at this address.
pub fn leave(address: usize) -> bool {
    let mut registry = REGISTRY.write().unwrap_or_else(PoisonError::into_inner);
    let Ok(at) = registry.instances.binary_search(&address) else {
        return false;
    };
    registry.instances.remove(at);
    if registry.instances.is_empty() {
        registry.instances = Vec::new();
    }
    true
}

/// Forgets components that no instance uses any more.
pub fn sweep() {
    let mut registry = REGISTRY.write().unwrap_or_else(PoisonError::into_inner);
    registry
        .components
        .retain(|(_, component)| component.strong_count() > 0);
    if registry.components.is_empty() {
        registry.components = Vec::new();
    }
}

/// The component of this key, made when no instance of the process has it. Two threads may both make it; then one wins.
pub fn shared(key: u64, make: &mut dyn FnMut() -> Outcome<Component>) -> Outcome<Arc<Component>> {
    let find = |registry: &Registry| {
        let entry = registry.components.iter().find(|(k, _)| *k == key);
        entry.and_then(|(_, component)| component.upgrade())
    };
    if let Some(found) = find(&REGISTRY.read().unwrap_or_else(PoisonError::into_inner)) {
        return Ok(found);
    }
    let made = Arc::new(make()?);
    let mut registry = REGISTRY.write().unwrap_or_else(PoisonError::into_inner);
    if let Some(found) = find(&registry) {
        return Ok(found);
    }
    registry
        .components
        .retain(|(k, component)| *k != key && component.strong_count() > 0);
    registry.components.push((key, Arc::downgrade(&made)));
    Ok(made)
}
