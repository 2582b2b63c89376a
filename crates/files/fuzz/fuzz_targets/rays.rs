//! Whatever a ray file contains, it is refused, or its rays are finite and can be written and read again.

#![no_main]

use libfuzzer_sys::fuzz_target;
use lumiduct_files::rays::{RayFormat, RayReader, write};

fuzz_target!(|input: (u8, &[u8])| {
    let (format, bytes) = input;
    let format = [RayFormat::Tm25, RayFormat::Zemax, RayFormat::Csv][usize::from(format % 3)];
    let Ok(reader) = RayReader::of_bytes(bytes.to_vec(), format) else { return };
    let info = reader.info().clone();
    let Ok(rays) = reader.collect::<Result<Vec<_>, _>>() else { return };
    assert!(rays.iter().all(|ray| ray.flux.is_finite()));
    let mut again = Vec::new();
    let written = write(&mut again, format, &info, rays.iter().copied().map(Ok));
    assert!(written.is_ok() && RayReader::of_bytes(again, format).is_ok());
});
