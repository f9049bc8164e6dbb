/// The last few of things that take long to make, by what they are made for: what is left for a while and come back to, a lighting that is
/// compared with another, is not made twice. Drivers do not give back all that a pipeline took.
#[derive(Debug)]
pub struct Recent<Key, Made>(Vec<(Key, Made)>);

/// How many are kept.
const KEPT: usize = 8;

impl<Key, Made> Default for Recent<Key, Made> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<Key: PartialEq, Made> Recent<Key, Made> {
    /// The one for a key, made if it is not there.
    ///
    /// # Errors
    ///
    /// Those of making it.
    pub fn get<Error>(
        &mut self,
        key: Key,
        make: impl FnOnce(&Key) -> Result<Made, Error>,
    ) -> Result<&Made, Error> {
        match self.0.iter().position(|(known, _)| *known == key) {
            Some(index) => self.0[..=index].rotate_right(1),
            None => {
                let made = make(&key)?;
                self.0.truncate(KEPT - 1);
                self.0.insert(0, (key, made));
            }
        }
        Ok(&self.0[0].1)
    }

    /// The one that was asked for last.
    pub fn last(&self) -> Option<&Made> {
        self.0.first().map(|(_, made)| made)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_few_are_kept() {
        let mut recent = Recent::default();
        let mut made = Vec::new();
        let mut get = |key: usize| {
            let found = recent.get(key, |key| {
                made.push(*key);
                if *key == 99 { Err("none") } else { Ok(10 * key) }
            });
            found.copied()
        };
        for key in (0..KEPT).chain([0, KEPT, 0, 1]) {
            assert_eq!(get(key), Ok(10 * key));
        }
        assert_eq!(get(99), Err("none"));
        assert_eq!(get(1), Ok(10));
        // 0 had been asked for again when there was no more room, so 1 had to go.
        assert_eq!(made[KEPT..], [KEPT, 1, 99]);
        assert_eq!(recent.last(), Some(&10));
    }
}
