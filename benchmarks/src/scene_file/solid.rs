//! Solid gears as elastic bodies need them: with a bore for the hub to hold.

use super::{SceneError, SceneFile};
use gearbench_models::spec::Body;
use toml_edit::{DocumentMut, Item, TomlError, value};

/// Bore over root radius: that of a gear on a shaft with a key.
const BORE: f64 = 0.5;

impl SceneFile {
    /// The scene with a bore of half the root radius in each solid gear, which keeps the inertia that it had, and a
    /// sentence on each.
    ///
    /// # Errors
    /// [`SceneError`] when the text with bores is no scene.
    pub fn with_bores(self) -> Result<(Self, Vec<String>), SceneError> {
        let mut document: DocumentMut = self.text().parse().map_err(|e: TomlError| {
            SceneError::plain(e.to_string(), "bores are written into a scene that is TOML")
        })?;
        let mut said = Vec::new();
        for g in &self.spec.gears {
            let Body::Gear(gear) = &g.body else { continue };
            if gear.params().bore_radius > 0.0 {
                continue;
            }
            let Some(table) = (document.get_mut("gears"))
                .and_then(|gears| gears.get_mut(&g.name))
                .and_then(Item::as_table_like_mut)
            else {
                continue;
            };
            // Four digits are enough for what is assumed.
            let bore: f64 = format!("{:.3e}", BORE * gear.r_root())
                .parse()
                .unwrap_or(0.0);
            table.insert("bore_radius_m", value(bore));
            if g.inertia.is_none() {
                let own = gear.mass_properties(g.material.density).izz;
                table.insert("inertia_kgm2", value(own));
            }
            said.push(format!(
                "`{}` is solid, and an elastic body needs a hub: it is taken with a bore of {} mm and the inertia of the solid gear",
                g.name,
                1e3 * bore
            ));
        }
        if said.is_empty() {
            return Ok((self, said));
        }
        let name = self.document.name().to_owned();
        let mut scene = Self::unbuilt(&name, &document.to_string(), self.origin, true)?;
        scene.odd = self.odd;
        Ok((scene, said))
    }
}
