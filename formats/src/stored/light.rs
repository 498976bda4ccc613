//! The light file: optics, local equilibrium, and the factors of the direct solver.

use super::{Stored, array_of, check, finite_array, finite_lights};
use crate::baked::{BakedLight, BoundaryResponses, Factors, LocalEquilibrium, Lu};
use crate::container::{Kind, Reader, Writer};
use crate::error::Result;
use crate::fingerprint::Manifest;
use crate::geometry::Optics;
use crate::part::LocalSolver;
use crate::rgb::Rgb;
use serde::{Deserialize, Serialize};

#[derive(Serialize, Deserialize)]
struct Meta {
    solver: LocalSolver,
    factors: Option<FactorsMeta>,
    answers: usize,
    returned: Rgb,
}

#[derive(Serialize, Deserialize)]
struct FactorsMeta {
    channels: usize,
    of_channel: [u32; 3],
}

impl Stored for BakedLight {
    const KIND: Kind = Kind::Light;

    fn write(&self, manifest: &Manifest) -> Writer {
        let factors = self.local.factors.as_ref();
        let factors_meta =
            factors.map(|f| FactorsMeta { channels: f.channels.len(), of_channel: f.of_channel });
        let answers = &self.local.answers;
        let meta = Meta {
            solver: self.local.solver,
            factors: factors_meta,
            answers: answers.radiosity.len(),
            returned: answers.returned,
        };
        let mut writer = Writer::new(Self::KIND, manifest, &meta);
        writer.array("reflectance", &Rgb::channels(&self.optics.reflectance));
        writer.array("emission", &Rgb::channels(&self.optics.emission));
        writer.array("radiosity", &Rgb::channels(&self.local.radiosity));
        for (i, lu) in factors.iter().flat_map(|f| &f.channels).enumerate() {
            writer.array(&factors_name(i), &lu.packed);
            writer.array(&permutation_name(i), &lu.rows);
        }
        for (i, radiosity) in answers.radiosity.iter().enumerate() {
            writer.array(&answer_name(i), &Rgb::channels(radiosity));
        }
        writer.array("answers' matrix", &Rgb::channels(&answers.matrix));
        writer
    }

    fn read(reader: &mut Reader) -> Result<Self> {
        let meta: Meta = reader.meta()?;
        let reflectance = finite_lights(reader, "reflectance")?;
        let elements = reflectance.len();
        let emission = lights_of(reader, "emission", elements)?;
        // One row an unknown: an element, or a patch of them.
        let radiosity = finite_lights(reader, "radiosity")?;
        let unknowns = radiosity.len();
        check(reader, unknowns <= elements, || format!("{unknowns} unknowns of {elements} elements"))?;
        let factors =
            meta.factors.as_ref().map(|factors| read_factors(reader, factors, unknowns)).transpose()?;
        let answers = read_answers(reader, &meta, unknowns)?;
        let local = LocalEquilibrium { solver: meta.solver, radiosity, factors, answers };
        Ok(Self { optics: Optics { reflectance, emission }, local })
    }
}

fn factors_name(channel: usize) -> String {
    format!("factors {channel}")
}

fn permutation_name(channel: usize) -> String {
    format!("permutation {channel}")
}

fn answer_name(number: usize) -> String {
    format!("answer {number}")
}

fn read_answers(reader: &mut Reader, meta: &Meta, unknowns: usize) -> Result<BoundaryResponses> {
    let of = |number| lights_of(reader, &answer_name(number), unknowns);
    let radiosity: Vec<Vec<Rgb>> = (0..meta.answers).map(of).collect::<Result<_>>()?;
    let matrix = finite_lights(reader, "answers' matrix")?;
    let pairs = radiosity.len() * radiosity.len();
    check(reader, matrix.len() == pairs, || {
        format!("{} entries for {pairs} pairs of answers", matrix.len())
    })?;
    check(reader, meta.returned.iter().all(|share| share.is_finite()), || {
        "a share that is no number".into()
    })?;
    Ok(BoundaryResponses { radiosity, matrix, returned: meta.returned })
}

fn lights_of(reader: &mut Reader, name: &str, count: usize) -> Result<Vec<Rgb>> {
    let rows = finite_lights(reader, name)?;
    check(reader, rows.len() == count, || format!("{} rows of {name} instead of {count}", rows.len()))?;
    Ok(rows)
}

fn read_factors(reader: &mut Reader, meta: &FactorsMeta, unknowns: usize) -> Result<Factors> {
    let FactorsMeta { channels: count, of_channel } = *meta;
    check(reader, of_channel.iter().all(|&channel| (channel as usize) < count), || {
        format!("channels {of_channel:?} of {count} factors")
    })?;
    let channels = (0..count).map(|channel| read_lu(reader, channel, unknowns)).collect::<Result<_>>()?;
    Ok(Factors { channels, of_channel })
}

fn read_lu(reader: &mut Reader, channel: usize, size: usize) -> Result<Lu> {
    let packed = finite_array(reader, &factors_name(channel))?;
    let rows = array_of::<u32>(reader, &permutation_name(channel), size)?;
    check(reader, packed.len() == size * size, || format!("{} factors of {size} unknowns", packed.len()))?;
    check(reader, (0..size).all(|i| packed[i * (size + 1)] != 0.0), || "factors with a zero pivot".into())?;
    check(reader, is_permutation(&rows), || "a permutation that names a row twice".into())?;
    Ok(Lu { size: size as u32, packed, rows })
}

fn is_permutation(rows: &[u32]) -> bool {
    let mut seen = vec![false; rows.len()];
    rows.iter().all(|&row| seen.get_mut(row as usize).is_some_and(|seen| !std::mem::replace(seen, true)))
}
