use super::*;
use crate::optics::two_stream::{Cone, Layer, solve};

/// Of `at`: albedos, T' before and behind, then optical thickness, g and mu0, and the number of what is wanted. The column is of three
/// such layers in one light.
const LAYER: &str = "
let layer = two_stream_layer(at.n_o.x, at.between, at.n_o.y, at.n_o.z, at.n_i, at.to_light);
let one = two_stream_add(TwoStreamStack(vec3f(1.0), vec3f(0.0)), layer);
let two = two_stream_add(one, layer);
let three = two_stream_add(two, layer);
let last = two_stream_resolve(two, layer, vec3f(0.0));
let middle = two_stream_resolve(one, layer, last.backward);
var all = array(layer.r, layer.t, layer.absorbed, layer.s_forward, layer.s_backward,
    three.down, last.backward, middle.forward, middle.backward);
return vec4f(all[u32(at.first)], 0.0);
";

/// The same in 64 bits for one albedo.
fn expected(tau: f64, albedo: f64, g: f64, mu0: f64, beam: [f64; 2]) -> [f64; 9] {
    let layer = Layer::new(&Cone::new(g), tau, albedo, mu0, beam);
    let streams = solve(&[layer; 3]);
    [
        layer.r,
        layer.t,
        layer.absorbed,
        layer.s_forward,
        layer.s_backward,
        streams[3].forward,
        streams[2].backward,
        streams[1].forward,
        streams[1].backward,
    ]
}

#[test]
#[cfg_attr(not(tyndall_gpu), ignore = "no graphics adapter")]
fn layers_keep_their_digits_at_every_extreme() {
    let (mut cases, mut wanted) = (Vec::new(), Vec::new());
    for tau in [0.0, 1e-6, 1e-3, 0.2, 1.0, 7.0, 100.0, 1e4, 1e6f32] {
        for albedo in [[1.0, 0.999_999, 0.99], [0.9, 0.5, 0.0], [1.0, 1.0, 1e-6f32]] {
            for g in [-0.999, -0.5, 0.0, 0.5, 0.9, 0.999f32] {
                for mu0 in [1.0, 0.5, 1e-3f32] {
                    let own = albedo.map(|albedo| {
                        let beam = Cone::new(f64::from(g)).beam(f64::from(albedo));
                        // Subnormal numbers have lost their digits before they come.
                        let beam = (-beam * f64::from(tau) / f64::from(mu0)).exp() as f32;
                        if beam.is_normal() { beam } else { 0.0 }
                    });
                    let behind = [own, [1.0, 0.99, 0.5], [0.0, 1e-20, 2.0]];
                    for (second, first) in
                        behind.into_iter().flat_map(|second| (0..9).map(move |n| (second, n)))
                    {
                        cases.push(Case {
                            between: Vec3::from(albedo),
                            n_i: Vec3::ONE,
                            to_light: Vec3::from(second),
                            n_o: Vec3::new(tau, g, mu0),
                            first: first as f32,
                            ..Default::default()
                        });
                        wanted.push([0, 1, 2].map(|channel| {
                            let [tau, g, mu0] = [tau, g, mu0].map(f64::from);
                            let beam = [1.0, f64::from(second[channel])];
                            let all = expected(tau, f64::from(albedo[channel]), g, mu0, beam);
                            // A stack's reflectance is 1 less what 32 bits hold, so that of the streams only what matters has digits.
                            let least = all[5..].iter().copied().fold(0.0, f64::max) * 1e-3;
                            (all[first], if first < 5 { 1e-20 } else { least.max(1e-20) })
                        }));
                    }
                }
            }
        }
    }
    let found = evaluate(false, LAYER, &any_medium(), &cases);
    let mut worst = Worst::default();
    for ((found, wanted), case) in found.iter().zip(&wanted).zip(&cases) {
        for (channel, (wanted, least)) in wanted.iter().enumerate() {
            let found = f64::from(found[channel]);
            assert!(found.is_finite() && found >= 0.0, "{found} for {wanted} in {channel} of {case:?}");
            let error = (found - wanted).abs() / wanted.max(*least);
            worst.see(error, || format!("{found} for {wanted} in {channel} of {case:?}"));
        }
    }
    worst.check(1e-4, "two streams, relative");
}
