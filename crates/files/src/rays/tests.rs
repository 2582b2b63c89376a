use super::*;
use crate::bytes::tests::mutants;
use crate::rays::sampling::sampled;
use lumiduct_base::units::FluxUnit;
use rand_core::{Rng, SeedableRng};
use rand_xoshiro::SplitMix64;

const FORMATS: [RayFormat; 3] = [RayFormat::Tm25, RayFormat::Zemax, RayFormat::Csv];

fn random_rays(count: u64) -> Vec<FileRay> {
    let mut random = SplitMix64::seed_from_u64(3);
    let mut unit = || random.next_u32() as f32 / u32::MAX as f32;
    (0..count)
        .map(|_| {
            let [z, turn] = [unit(), unit()].map(f64::from);
            let (across, around) = ((1.0 - z * z).sqrt(), std::f64::consts::TAU * turn);
            FileRay {
                position_mm: [unit() - 0.5, 1e3 * unit(), -unit()],
                direction: [across * around.cos(), across * around.sin(), z].map(|own| own as f32),
                flux: 1e-3 * unit(),
            }
        })
        .collect()
}

fn info(rays: &[FileRay], unit: FluxUnit) -> RaySetInfo {
    RaySetInfo {
        count: rays.len() as u64,
        unit,
        flux: rays.iter().map(|ray| f64::from(ray.flux)).sum(),
        luminous_flux_lm: None,
        is_measured: false,
        texts: vec![(RayText::Name, "LED µ1".into()), (RayText::Operation, "150 mA".into())],
    }
}

fn bytes(format: RayFormat, rays: &[FileRay], unit: FluxUnit) -> Vec<u8> {
    let mut out = Vec::new();
    write(&mut out, format, &info(rays, unit), rays.iter().copied().map(Ok)).unwrap();
    out
}

fn open(bytes: &[u8], format: RayFormat) -> Result<RayReader, RayFileError> {
    RayReader::of_bytes(bytes.to_vec(), format)
}

fn read(bytes: &[u8], format: RayFormat) -> Result<Vec<FileRay>, RayFileError> {
    open(bytes, format)?.collect()
}

#[track_caller]
fn refused(bytes: &[u8], format: RayFormat, parts: &[&str]) {
    let error = read(bytes, format).unwrap_err().to_string();
    for part in parts {
        assert!(error.contains(part), "{error}");
    }
}

#[test]
fn rays_come_back_from_every_format_to_the_last_bit() {
    let rays = random_rays(1000);
    for (format, unit) in
        FORMATS.into_iter().zip([FluxUnit::Lumen, FluxUnit::Watt, FluxUnit::Lumen])
    {
        let file = bytes(format, &rays, unit);
        let reader = open(&file, format).unwrap();
        let found = reader.info().clone();
        assert_eq!((found.count, found.unit), (1000, unit));
        let stated = info(&rays, unit);
        assert!((found.flux / stated.flux - 1.0).abs() < 1e-6, "{format}: {}", found.flux);
        assert_eq!(reader.remarks(), [""; 0], "{format}");
        assert_eq!(reader.collect::<Result<Vec<_>, _>>().unwrap(), rays, "{format}");
    }
    let texts = open(&bytes(RayFormat::Tm25, &rays, FluxUnit::Lumen), RayFormat::Tm25).unwrap();
    assert_eq!(texts.info().texts, info(&rays, FluxUnit::Lumen).texts);
}

/// A TM-25 file with one ray, four bytes of its header changed, and bytes put in before the ray.
fn tm25(changes: &[(usize, i32)], inserted: &[u8]) -> Vec<u8> {
    let mut file = bytes(RayFormat::Tm25, &random_rays(1), FluxUnit::Watt);
    for (at, value) in changes {
        file[*at..at + 4].copy_from_slice(&value.to_le_bytes());
    }
    file.splice(36_288..36_288, inserted.iter().copied());
    file
}

#[test]
fn rays_of_tm25_follow_its_tables_columns_and_text() {
    let rays = random_rays(1);
    // A table of 51 pairs: 4 + 408 bytes, filled up to 416.
    let mut table = 51i32.to_le_bytes().to_vec();
    table.extend([0; 412]);
    let file = tm25(&[(60, 3), (76, 1)], &table);
    assert_eq!(file.len(), 36_704 + 28);
    let reader = open(&file, RayFormat::Tm25).unwrap();
    assert_eq!(reader.remarks(), ["its spectra, wavelengths and colours are not used"]);
    assert_eq!(reader.collect::<Result<Vec<_>, _>>().unwrap(), rays);
    // The name of a column with 512 bytes, and its number in every ray.
    let mut file = tm25(&[(80, 1), (84, 32)], &[0; 512 + 32]);
    file.extend(7f32.to_le_bytes());
    let reader = open(&file, RayFormat::Tm25).unwrap();
    assert_eq!(reader.remarks(), ["its additional columns and text are not used"]);
    assert_eq!(reader.collect::<Result<Vec<_>, _>>().unwrap(), rays);
    let later = tm25(&[(4, 2020)], &[]);
    assert!(open(&later, RayFormat::Tm25).unwrap().remarks()[0].contains("read as 2013"));
    // Luminous flux after radiant flux and a wavelength; luminous flux of the header beside radiant rays.
    let mut file = tm25(&[(256 + 12, 1), (256 + 16, 1)], &[]);
    file.extend(550f32.to_le_bytes());
    file.extend(2.5f32.to_le_bytes());
    let reader = open(&file, RayFormat::Tm25).unwrap();
    assert_eq!(reader.info().unit, FluxUnit::Lumen);
    assert!(reader.remarks().iter().any(|own| own.contains("the radiant ones are not used")));
    assert_eq!(reader.collect::<Result<Vec<_>, _>>().unwrap()[0].flux, 2.5);
    let file = tm25(&[(12, 8f32.to_bits() as i32)], &[]);
    assert_eq!(open(&file, RayFormat::Tm25).unwrap().info().luminous_flux_lm, Some(8.0));
    // That rays were measured is kept.
    let measured = open(&tm25(&[(8, 1)], &[]), RayFormat::Tm25).unwrap();
    assert!(measured.info().is_measured);
    let mut again = Vec::new();
    write(&mut again, RayFormat::Tm25, measured.info(), rays.iter().copied().map(Ok)).unwrap();
    assert_eq!(again[8..12], [1, 0, 0, 0]);
}

#[test]
fn tm25_files_that_are_wrong_are_refused_at_their_byte() {
    let refuse = |file: &[u8], parts: &[&str]| refused(file, RayFormat::Tm25, parts);
    let whole = tm25(&[], &[]);
    refuse(&whole[..36_300], &["byte 36288", "promises 1 rays", "has 0 and 12 further bytes"]);
    refuse(&[whole.clone(), vec![0; 3]].concat(), &["byte 36288", "has 1 and 3 further bytes"]);
    refuse(&whole[..99], &["byte 99", "ends within its header"]);
    refuse(&tm25(&[(0, 0)], &[]), &["byte 0", "TM25"]);
    refuse(&tm25(&[(4, 1999)], &[]), &["byte 4", "version is 1999"]);
    refuse(&tm25(&[(12, (-1f32).to_bits() as i32)], &[]), &["byte 12", "flux is -1"]);
    refuse(&tm25(&[(20, 0)], &[]), &["byte 20", "no rays"]);
    refuse(&tm25(&[(24, -1)], &[]), &["promises"]);
    refuse(&tm25(&[(76, -1)], &[]), &["byte 76", "-1"]);
    refuse(&tm25(&[(76, i32::MAX)], &[]), &["spectral table"]);
    refuse(&tm25(&[(76, 1)], &i32::MAX.to_le_bytes()), &["longer than the file"]);
    refuse(&tm25(&[(80, i32::MAX)], &[]), &["byte 80", "additional columns do not fit"]);
    refuse(&tm25(&[(84, i32::MAX)], &[]), &["byte 84", "bytes of text do not fit"]);
    refuse(&tm25(&[(256, 0)], &[]), &["byte 256", "no positions"]);
    refuse(&tm25(&[(260, 0)], &[]), &["byte 260", "no directions"]);
    refuse(&tm25(&[(264, 0)], &[]), &["byte 264", "no flux"]);
    refuse(&tm25(&[(268, 2)], &[]), &["byte 268", "not 0 or 1"]);
    refuse(&tm25(&[(288, -1)], &[]), &["byte 288", "UTF-32"]);
}

#[test]
fn rays_that_are_none_are_refused_in_every_format() {
    let good = random_rays(3);
    type Change = fn(&mut FileRay);
    let wrong: [(Change, &str); 5] = [
        (|ray| ray.flux = f32::NAN, "NaN"),
        (|ray| ray.flux = -1e-5, "cannot be negative"),
        (|ray| ray.direction = [0.0, 0.5, 0.0], "length of 0.5000"),
        (|ray| ray.position_mm[0] = 1e8, "at most 1e7 mm"),
        (|ray| ray.position_mm[2] = f32::INFINITY, "inf"),
    ];
    for (change, part) in wrong {
        let mut rays = good.clone();
        change(&mut rays[1]);
        refused(
            &bytes(RayFormat::Tm25, &rays, FluxUnit::Lumen),
            RayFormat::Tm25,
            &["ray 2 at byte 36316", part],
        );
        refused(
            &bytes(RayFormat::Zemax, &rays, FluxUnit::Lumen),
            RayFormat::Zemax,
            &["ray 2 at byte 236", part],
        );
        refused(&bytes(RayFormat::Csv, &rays, FluxUnit::Lumen), RayFormat::Csv, &["line 5", part]);
    }
    // What the writer refuses, too.
    let large = bytes(RayFormat::Tm25, &good, FluxUnit::Lumen);
    let flux = |value: f32| {
        let mut file = large.clone();
        let last = file.len() - 4;
        file[last..].copy_from_slice(&value.to_le_bytes());
        file
    };
    assert_eq!(read(&flux(1e30), RayFormat::Tm25).unwrap()[2].flux, 1e30);
    refused(&flux(1e38), RayFormat::Tm25, &["ray 3 at byte 36344", "flux is 1e38; at most 1e30"]);
    // Nearly a unit vector: it is made one.
    let mut rays = good;
    rays[1].direction = [0.0, 0.0, 0.9995];
    let found = read(&bytes(RayFormat::Tm25, &rays, FluxUnit::Lumen), RayFormat::Tm25).unwrap();
    assert_eq!(found[1].direction, [0.0, 0.0, 1.0]);
}

#[test]
fn source_files_of_opticstudio_have_units_and_a_text_form() {
    let ray = FileRay { position_mm: [1.0, 2.0, 3.0], direction: [0.0, 0.0, 1.0], flux: 0.5 };
    let mut file = bytes(RayFormat::Zemax, &[ray], FluxUnit::Lumen);
    for (code, factor) in [(0, 1000.0f32), (1, 25.4), (2, 10.0), (3, 304.8), (4, 1.0)] {
        file[136] = code;
        let found = read(&file, RayFormat::Zemax).unwrap()[0];
        assert_eq!(found.position_mm, ray.position_mm.map(|own| own * factor));
        assert_eq!(found.flux, 0.5);
    }
    file[136] = 5;
    refused(&file, RayFormat::Zemax, &["byte 136", "5 is no unit"]);
    file[136] = 4;
    file[140..144].copy_from_slice(&1f32.to_le_bytes());
    assert!(open(&file, RayFormat::Zemax).unwrap().remarks()[0].contains("`at`"));
    file[164..168].copy_from_slice(&2f32.to_le_bytes());
    assert!(open(&file, RayFormat::Zemax).unwrap().remarks()[1].contains("[2.0, 1.0, 1.0]"));
    file[4..8].fill(0);
    refused(&file, RayFormat::Zemax, &["byte 4", "no rays"]);
    file[4] = 1;
    file[192] = 1;
    refused(&file, RayFormat::Zemax, &["byte 192", "type 1"]);
    let text = "\u{feff}2 2\r\n1 2 3 0 0 1 0.5\r\n\r\n1 2 3 0 0 1 0.5 0.55\r\n";
    let reader = open(text.as_bytes(), RayFormat::Zemax).unwrap();
    assert!(reader.remarks()[0].contains("W is assumed"));
    let found = reader.collect::<Result<Vec<_>, _>>().unwrap();
    assert_eq!((found.len(), found[1].position_mm), (2, [10.0, 20.0, 30.0]));
    let refuse = |text: &str, parts: &[&str]| refused(text.as_bytes(), RayFormat::Zemax, parts);
    refuse("3 4\n1 2 3 0 0 1 1\n", &["line 3", "fewer rays than the 3"]);
    refuse("1 4\n1 2 3 0 0 1 1\n1 2 3 0 0 1 1\n", &["line 3", "more rays"]);
    refuse("1 4\n1 2 3 0 0 1\n", &["line 2", "seven numbers"]);
    refuse("1 4\n1 2 x 0 0 1 1\n", &["line 2", "`x` is not a number"]);
    refuse("0 4\n", &["no rays"]);
    refuse("lamp", &["line 1", "begins with 1010"]);
    refuse(&format!("1 4\n{}", "1".repeat(1 << 17)), &["line 2", "more than 65536 bytes"]);
    // Lines may end in CR.
    let old = "2 4\r1 2 3 0 0 1 1\r\r1 2 3 0 0 1 2\r";
    assert_eq!(read(old.as_bytes(), RayFormat::Zemax).unwrap()[1].flux, 2.0);
    refuse(&old.replace("1 2\r", "1 x\r"), &["line 4", "`x` is not a number"]);
}

#[test]
fn csv_may_have_comments_any_order_and_any_line_ends() {
    let text =
        "\u{feff}# lamp\r\nflux_lm, dz, dy, dx, z_mm, y_mm, x_mm, id\r\n2.5,1,0,0,3,2,1,a\r\n";
    let reader = open(text.as_bytes(), RayFormat::Csv).unwrap();
    assert_eq!(reader.remarks(), ["its further columns are not used"]);
    let ray = FileRay { position_mm: [1.0, 2.0, 3.0], direction: [0.0, 0.0, 1.0], flux: 2.5 };
    assert_eq!(reader.collect::<Result<Vec<_>, _>>().unwrap(), [ray]);
    let refuse = |text: &str, parts: &[&str]| refused(text.as_bytes(), RayFormat::Csv, parts);
    refuse("x_mm,y_mm\n1,2\n", &["line 1", "no column `flux_lm` or `flux_w`", "commas"]);
    refuse("x_mm,y_mm,flux_w\n1,2,3\n", &["no column `z_mm`"]);
    let head = "x_mm,y_mm,z_mm,dx,dy,dz,flux_lm\n";
    refuse(head, &["no rays follow"]);
    refuse(&format!("{head}0,0,0,0,0,1\n"), &["line 2", "6 columns instead of 7"]);
    refuse(&format!("{head}0,0,0,0,0,1,1\n0,0,0,0,0,1,-\n"), &["line 3", "`-` is not a number"]);
    refuse(&format!("{head}{}", "1".repeat(1 << 18)), &["line 2", "more than 65536 bytes"]);
    refuse(
        &head.replace("flux_lm", "flux_lm,flux_w"),
        &["line 1", "both columns `flux_lm` and `flux_w`"],
    );
    refuse(
        &head.replace("flux_lm", "flux_lm,X_mm"),
        &["line 1", "the column `x_mm` is there twice"],
    );
    refuse(
        &head.replace("flux_lm", "flux_w,flux_w"),
        &["line 1", "the column `flux_w` is there twice"],
    );
    // More lines than a buffer has, with each end.
    let rays = random_rays(2000);
    let many = String::from_utf8(bytes(RayFormat::Csv, &rays, FluxUnit::Lumen)).unwrap();
    for end in ["\r\n", "\r", "\n"] {
        assert_eq!(
            read(many.replace('\n', end).as_bytes(), RayFormat::Csv).unwrap(),
            rays,
            "{end:?}"
        );
    }
    let quoted =
        "\"x_mm\",\"y_mm\",\"z_mm\",\"dx\",\"dy\",\"dz\",\"flux_lm\"\n\"1\",2,3,0,0,1,2.5\n";
    assert_eq!(read(quoted.as_bytes(), RayFormat::Csv).unwrap(), [ray]);
}

#[test]
fn errors_of_csv_count_comments_and_blank_lines() {
    let head = "\u{feff}# lamp\n\n#\nx_mm,y_mm,z_mm,dx,dy,dz,flux_lm\n";
    let good = "0,0,0,0,0,1,1\n";
    for (text, parts) in [
        (format!("{head}0,0,0,0,0,1,-1\n{good}"), ["line 5", "negative"]),
        (format!("{head}{good}# x\n\n0,0,0,0,0,1,x\n{good}"), ["line 8", "`x` is not a number"]),
        (format!("{head}{good}# x\n{good}0,0,0\n"), ["line 8", "3 columns instead of 7"]),
        (format!("{head}{good}{good}0,0,0,0,0,2,1"), ["line 7", "length of 2.0000"]),
        (format!("{head}{good}# x\n{}", "1".repeat(1 << 17)), ["line 7", "more than 65536 bytes"]),
        (format!("{head}{good}#{}\n", "1".repeat(1 << 17)), ["line 6", "more than 65536 bytes"]),
        (format!("{head}{good}\"\n{}", good.repeat(1 << 14)), ["line 6", "1 columns instead of 7"]),
        ("# a\n# b\nx_mm,y_mm\n".to_owned(), ["line 3", "no column"]),
        ("# a\n# b\nx_mm,y_mm,z_mm,dx,dy,dz,flux_w\n# c\n".to_owned(), ["line 3", "no rays"]),
    ] {
        refused(text.as_bytes(), RayFormat::Csv, &parts);
        refused(text.replace('\n', "\r\n").as_bytes(), RayFormat::Csv, &parts);
        refused(text.replace('\n', "\r").as_bytes(), RayFormat::Csv, &parts);
    }
    // Comments may be in any encoding.
    let text = [head.as_bytes(), good.as_bytes(), b"# 5\xb0\n0,0,0,0,0,1,\xff\n"].concat();
    refused(&text, RayFormat::Csv, &["line 7", "is not a number"]);
}

#[test]
fn damaged_files_give_rays_or_an_error() {
    const MUTANTS: u64 = 100_000;
    let rays = random_rays(20);
    let written = FORMATS.map(|format| (format, bytes(format, &rays, FluxUnit::Lumen)));
    let row = |ray: &FileRay| ray.numbers().map(|number| number.to_string()).join(" ") + "\n";
    let text = format!("20 4\n{}", rays.iter().map(row).collect::<String>()).into_bytes();
    let all = written.into_iter().chain([(RayFormat::Zemax, text)]);
    for (place, (format, original)) in (0..).zip(all) {
        // Most of a TM-25 header is empty.
        let mut usable = 0;
        for bytes in mutants(&original, MUTANTS, 40 + place) {
            if let Ok(rays) = read(&bytes, format) {
                usable += 1;
                assert!(rays.iter().all(|ray| ray.numbers().iter().all(|own| own.is_finite())));
            }
        }
        assert!(MUTANTS / 100 < usable && usable < MUTANTS, "{format}: {usable}");
    }
}

#[test]
fn a_sample_has_every_ray_with_the_same_probability_and_the_order_of_the_file() {
    let rays = random_rays(40);
    let file = bytes(RayFormat::Csv, &rays, FluxUnit::Lumen);
    let sample =
        |most: usize, seed: u64| sampled(open(&file, RayFormat::Csv).unwrap(), most, seed).unwrap();
    assert_eq!(sample(100, 1).rays, rays);
    assert_eq!(sample(10, 5), sample(10, 5));
    let mut hits = [0u32; 40];
    const RUNS: u32 = 4000;
    for seed in 0..RUNS {
        let found = sample(10, seed.into());
        assert_eq!(found.rays.len(), 10);
        assert_eq!(found.info.flux, info(&rays, FluxUnit::Lumen).flux);
        let places: Vec<usize> =
            found.rays.iter().map(|ray| rays.iter().position(|own| own == ray).unwrap()).collect();
        assert!(places.is_sorted());
        places.iter().for_each(|place| hits[*place] += 1);
    }
    // Each ray with p = 1/4. Ten rays of each run make the 40 hits dependent: of their sum of squares over n p (1 - p), which has the mean
    // 40, 39 parts of 40/39 vary.
    let mean = f64::from(RUNS) / 4.0;
    let chi2: f64 = hits.iter().map(|hits| (f64::from(*hits) - mean).powi(2) / (0.75 * mean)).sum();
    assert!((40.0 - chi2).abs() < 4.0 * 40.0 * (2.0f64 / 39.0).sqrt(), "{chi2}");
}

#[test]
fn what_a_file_states_and_its_rays_sum_to_is_compared() {
    let mut rays = random_rays(4);
    let mut file = bytes(RayFormat::Tm25, &rays, FluxUnit::Lumen);
    file[12..16].copy_from_slice(&1f32.to_le_bytes());
    let found = sampled(open(&file, RayFormat::Tm25).unwrap(), 10, 0).unwrap();
    assert!(found.remarks[0].contains("its header states"), "{:?}", found.remarks);
    rays.iter_mut().for_each(|ray| ray.flux = 0.0);
    let dark = bytes(RayFormat::Tm25, &rays, FluxUnit::Lumen);
    let error = sampled(open(&dark, RayFormat::Tm25).unwrap(), 10, 0).unwrap_err();
    assert!(matches!(error, RayFileError::NoLight));
}

#[test]
fn what_cannot_be_written_is_refused() {
    let rays = random_rays(2);
    let mut info = info(&rays, FluxUnit::Lumen);
    info.count = 3;
    let mut out = Vec::new();
    let error = write(&mut out, RayFormat::Tm25, &info, rays.iter().copied().map(Ok)).unwrap_err();
    assert!(error.to_string().contains("2 rays, where the header has 3"), "{error}");
    info.count = 5_000_000_000;
    let error = write(&mut out, RayFormat::Zemax, &info, []).unwrap_err();
    assert!(error.to_string().contains("at most 4000000000"), "{error}");
    for format in FORMATS {
        let bright = [FileRay { flux: 1e38, ..rays[0] }; 4];
        let stated = RaySetInfo { count: 4, flux: 4e38, ..info.clone() };
        let error = write(&mut out, format, &stated, bright.map(Ok)).unwrap_err().to_string();
        assert!(error.contains("a flux of 4e38 lm"), "{error}");
        let stated = RaySetInfo { count: 1, flux: 1e38, ..info.clone() };
        let error = write(&mut out, format, &stated, [Ok(bright[0])]).unwrap_err().to_string();
        assert!(error.contains("a ray of 1e38 lm; at most 1e30 lm"), "{error}");
        let most = [FileRay { flux: 1e30, ..rays[0] }; 4];
        let stated = RaySetInfo { count: 4, flux: 4e30, ..info.clone() };
        let mut file = Vec::new();
        write(&mut file, format, &stated, most.map(Ok)).unwrap();
        assert_eq!(read(&file, format).unwrap(), most, "{format}");
    }
    info.count = 0;
    info.texts = vec![(RayText::Name, "é".repeat(1001))];
    let remarks = write(&mut out, RayFormat::Tm25, &info, []).unwrap();
    assert_eq!(remarks, ["the name is cut after 1000 letters"]);
    let remarks = write(&mut out, RayFormat::Zemax, &info, []).unwrap();
    assert_eq!(remarks, ["the texts are cut to 100 letters of ASCII"]);
    assert!(matches!(RayFormat::of("a.ray".as_ref()), Err(RayFileError::UnknownRays { .. })));
    assert_eq!(RayFormat::of("a.SDF".as_ref()).unwrap(), RayFormat::Zemax);
}
