use super::*;
use crate::colour::colour_matching;
use crate::measure::noise::Noise;

/// The light of a white LED: wavelengths, nm, and shares of the counts; a twentieth comes from the blue die.
const WHITE: [(f64, f64); 3] = [(450.0, 0.05), (550.0, 0.6), (610.0, 0.35)];
const TRIALS: u32 = 300;

/// Stimuli of a number of expected counts of a lumen each, as batches with few counts find them.
fn drawn(spectrum: &[(f64, f64)], counts: f64, noise: &mut Noise) -> NoisyStimuli {
    let mut sum = NoisyStimuli { mean: DVec3::ZERO, covariance: DMat3::ZERO };
    for (nm, share) in spectrum {
        let number = noise.poisson(counts * share);
        let one = stimuli(*nm);
        sum.mean += number * one;
        sum.covariance += number * DMat3::from_cols(one * one.x, one * one.y, one * one.z);
    }
    sum
}

/// Tristimulus values of a lumen of a wavelength.
fn stimuli(nm: f64) -> DVec3 {
    let seen = DVec3::from_array(colour_matching(nm));
    seen / seen.y
}

fn uv(of: DVec3) -> DVec2 {
    DVec2::from_array(Chromaticity::from_tristimulus(of.to_array()).unwrap().uv_1976())
}

/// Levels of light in all cells without errors.
fn levels(values: &[f64]) -> Vec<Option<Noisy>> {
    values.iter().map(|value| Some(Noisy { value: *value, std_error: 0.0, count: 0.0 })).collect()
}

#[test]
fn colours_of_few_counts_lie_within_their_errors() {
    let truth = uv(WHITE.iter().map(|(nm, share)| *share * stimuli(*nm)).sum());
    let mut noise = Noise::of_stream(1);
    for (cells, counts) in
        [(50, 30.0), (50, 60.0), (50, 100.0), (50, 1000.0), (1, 60.0), (1, 150.0), (1, 1000.0)]
    {
        let (mut held, mut known) = ([0.0; 2], 0.0);
        for _ in 0..TRIALS {
            let read: Vec<_> = (0..cells).map(|_| drawn(&WHITE, counts, &mut noise)).collect();
            let colours = CellColours::new(&read, 0.0);
            for own in colours.0.iter().flatten().filter(|own| own.covariance.is_finite()) {
                known += 1.0;
                let off = (own.read.uv - truth).to_array();
                let errors = [own.covariance.x_axis.x, own.covariance.y_axis.y].map(f64::sqrt);
                for axis in [0, 1] {
                    held[axis] += f64::from(off[axis].abs() <= 2.0 * errors[axis]);
                }
            }
        }
        // A normal distribution has 0.954; a share of 300 is known to 0.015.
        let held = held.map(|own| own / known);
        assert!(
            held.iter().all(|own| (0.9..0.985).contains(own)),
            "{cells} of {counts}: {held:?} of {known}"
        );
    }
}

#[test]
fn with_few_counts_errors_are_unknown() {
    let mut noise = Noise::of_stream(2);
    // Ten counts of light with little blue leave its share open; 40 counts in all may lack a colour.
    for (cells, counts) in [(50, 10.0), (1, 40.0)] {
        let read: Vec<_> = (0..cells).map(|_| drawn(&WHITE, counts, &mut noise)).collect();
        let colours = CellColours::new(&read, 0.0);
        let found = colours.distances(&levels(&vec![1.0; cells]));
        assert!(colours.0.iter().flatten().all(|own| !own.covariance.is_finite()));
        assert!(found.iter().all(|own| own.status == Status::TooFew), "{found:?}");
        assert!(found.iter().all(|own| own.std_error.is_infinite()), "{found:?}");
    }
}

#[test]
fn one_cell_has_no_spread_and_no_light_no_signal() {
    let mut noise = Noise::of_stream(3);
    let read = [1e5, 1e3].map(|counts| drawn(&WHITE, counts, &mut noise));
    let colours = CellColours::new(&read, 0.0);
    for (values, status) in [
        ([1.0, 0.05], Status::Undefined),
        ([0.0, 0.0], Status::NoSignal),
        ([-1.0, 0.0], Status::NoSignal),
    ] {
        let found = colours.distances(&levels(&values));
        assert!(found.iter().all(|own| own.status == status), "{found:?}");
        assert!(found.iter().all(|own| own.std_error.is_infinite()), "{found:?}");
    }
}

#[test]
fn negative_stimuli_have_no_colour_and_no_panic() {
    let mut noise = Noise::of_stream(4);
    let mut read = vec![drawn(&WHITE, 1e4, &mut noise); 3];
    read[1].mean = DVec3::new(3.0, -0.1, 1.0);
    read[2].mean = DVec3::NAN;
    let colours = CellColours::new(&read, 0.0);
    assert!(colours.0[1..].iter().all(Option::is_none));
    let found = colours.distances(&levels(&[1.0; 3]));
    assert!(found.iter().all(|own| own.status == Status::TooFew), "{found:?}");
}

#[test]
fn cells_whose_level_is_in_doubt_add_to_the_bias() {
    let mut noise = Noise::of_stream(5);
    let (blue, red) = ([(450.0, 1.0)], [(610.0, 1.0)]);
    let read = [&red, &red, &blue].map(|of| drawn(of, 1e5, &mut noise));
    let colours = CellColours::new(&read, 0.0);
    let of = |share: f64, std_error: f64| {
        let mut levels = levels(&[1.0, 0.9, share]);
        levels[2] = Some(Noisy { value: share, std_error, count: 0.0 });
        colours.distances(&levels)
    };
    let apart = uv(stimuli(450.0)).distance(uv(stimuli(610.0)));
    // A blue cell with 9 % of the level does not count, but may: with an error of 2 % it is among the possible ones.
    for (share, std_error, is_in, bias) in [
        (0.09, 0.001, false, false),
        (0.09, 0.02, false, true),
        (0.11, 0.001, true, false),
        (0.11, 0.02, true, true),
    ] {
        let [largest, rms] = of(share, std_error);
        assert_eq!(largest.value > 0.5 * apart, is_in, "{largest:?}");
        for own in [largest, rms] {
            assert_eq!(own.bias.is_some_and(|own| own > 0.3 * apart), bias, "{own:?}");
        }
    }
}

#[test]
fn cells_in_doubt_may_leave_a_single_one_or_one_of_unknown_colour() {
    let mut noise = Noise::of_stream(6);
    let (blue, red) = ([(450.0, 1.0)], [(610.0, 1.0)]);
    let read = [&red, &blue].map(|of| drawn(of, 1e5, &mut noise));
    let mut in_doubt = levels(&[1.0, 0.105]);
    in_doubt[1] = Some(Noisy { value: 0.105, std_error: 0.01, count: 0.0 });
    // The distance may not exist at all.
    for own in CellColours::new(&read, 0.0).distances(&in_doubt) {
        assert!(own.bias.unwrap() > 0.9 * own.value, "{own:?}");
    }
    let dim = [&red, &red, &blue].map(|of| drawn(of, 1e5, &mut noise));
    let few = [dim[0], dim[1], drawn(&blue, 2.0, &mut noise)];
    let mut in_doubt = levels(&[1.0, 0.9, 0.095]);
    in_doubt[2] = Some(Noisy { value: 0.095, std_error: 0.01, count: 0.0 });
    let found = CellColours::new(&few, 0.0).distances(&in_doubt);
    assert!(found.iter().all(|own| own.status == Status::TooFew), "{found:?}");
    in_doubt[2] = Some(Noisy { value: 0.105, std_error: f64::INFINITY, count: 0.0 });
    let found = CellColours::new(&dim, 0.0).distances(&in_doubt);
    assert!(found.iter().all(|own| own.status == Status::TooFew), "{found:?}");
}
