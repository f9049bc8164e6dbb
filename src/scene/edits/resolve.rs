//! Conflicts are decided.

use super::change::Change;
use super::conflict::{Conflict, Content, Side, Version};
use super::draft::DraftComponent;
use super::{EditError, Edits, registry_of};
use bevy_ecs::world::World;

impl Edits {
    /// What is in conflict with the files and not resolved yet.
    pub fn conflicts(&self) -> &[Conflict] {
        &self.conflicts
    }

    /// Decides a conflict: with [`Side::Ours`] the edit is made again, with [`Side::Theirs`] what the file has stays. Either is a step
    /// that can be undone if it changes what is shown.
    ///
    /// # Errors
    ///
    /// If there is no such conflict, or the edit cannot be made in the scene as it is now; then the conflict stays.
    pub fn resolve(&mut self, world: &mut World, conflict: u64, side: Side) -> Result<(), EditError> {
        let at = self.conflicts.iter().position(|known| known.id == conflict).ok_or(EditError::NoConflict)?;
        let registry = registry_of(world);
        let registry = registry.read();
        let known = &self.conflicts[at];
        let wanted = match side {
            Side::Ours => known.ours.copied(&registry)?,
            Side::Theirs => known.theirs.copied(&registry)?,
        };
        let (entity, path) = (known.entity.clone(), known.path.clone());
        let shown = Version::of(&self.document, entity.as_deref(), &path, &registry)?;
        if !shown.is_like(&wanted, &registry) {
            let changes = changes(entity, path, shown.0, wanted.0)?;
            self.make(world, &registry, changes)?;
        }
        self.conflicts.retain(|known| known.id != conflict);
        Ok(())
    }
}

/// What makes `wanted` of what is shown.
fn changes(
    entity: Option<String>,
    path: String,
    shown: Content,
    wanted: Content,
) -> Result<Vec<Change>, EditError> {
    let missing = EditError::NoValue {
        entity: entity.clone().unwrap_or_else(|| "the head of the scene".into()),
        path: path.clone(),
    };
    let component = |before: Option<DraftComponent>, after: Option<DraftComponent>| {
        let entity = entity.clone().unwrap_or_default();
        vec![Change::Component { entity, name: path.clone(), before, after }]
    };
    let value =
        |before, after| vec![Change::Value { entity: entity.clone(), path: path.clone(), before, after }];
    Ok(match (shown, wanted) {
        (Content::Value(before), Content::Value(after)) => value(before, after),
        (Content::Component(before), Content::Value(after)) => value(before.value, after),
        (Content::Value(before), Content::Component(after)) => value(before, after.value),
        (Content::Component(before), Content::Component(after)) => component(Some(before), Some(after)),
        (Content::Component(before), Content::Nothing) => component(Some(before), None),
        (Content::Nothing, Content::Component(after)) => component(None, Some(after)),
        (Content::Entity(name, before), Content::Nothing) => {
            vec![Change::Entity { name, before: Some(before), after: None }]
        }
        (Content::Nothing, Content::Entity(name, after)) => {
            vec![Change::Entity { name, before: None, after: Some(after) }]
        }
        (Content::Entity(from, before), Content::Entity(to, after)) => {
            let exchange = Change::Entity { name: from.clone(), before: Some(before), after: Some(after) };
            let rename = (from != to).then_some(Change::Rename { from, to });
            [exchange].into_iter().chain(rename).collect()
        }
        (Content::Nothing, Content::Nothing) => Vec::new(),
        _ => return Err(missing),
    })
}
