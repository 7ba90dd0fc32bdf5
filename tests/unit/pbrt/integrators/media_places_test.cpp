// Media in instances and in moving shapes, and the emission of media against quadrature.
#include <array>

#include "volume_scenes.h"

namespace pbrt::test {
namespace {

const std::string kFog = Homogeneous("'rgb sigma_a' [0 0 0] 'rgb sigma_s' [2 2 2] 'float g' .4"),
                  kFoggyBall = FilledWith() + "Shape 'sphere'\n";

TEST(MediaInPlaces, AFurnaceInAnInstanceOrInMotionIsInvisible) {
    const std::string instances =
        Objects()
            .Add(kEvenSky + kFog + "ObjectBegin 'ball'\n" + kFoggyBall + "ObjectEnd")
            .Attribute("Translate .3 0 0 Scale .5 .7 .9", Objects().Add("ObjectInstance 'ball'"))
            .Attribute("Translate -.3 .1 -3 Scale -.8 1 1", Objects().Add("ObjectInstance 'ball'"));
    ExpectOfSky(Green(instances, {"volpath", 1000, 128}), 1);
    const std::string moving =
        kEvenSky + kFog + "ActiveTransform EndTime\nTranslate .7 .2 0\nActiveTransform All\n" + kFoggyBall;
    ExpectOfSky(Green(moving, {"volpath", 1000, 128}), 1);
}

TEST(MediaInPlaces, AnInstanceThatIsStretchedHoldsMoreOfTheMedium) {
    // What absorbs is per unit of length of the world, so a slab of thickness 1 that is stretched twofold takes 2
    // units.
    const std::string stretched = Objects()
                                      .Add(kEvenSky + Absorbing(.6) + "ObjectBegin 'slab'")
                                      .Add(Slab(-.5, .5))
                                      .Add("ObjectEnd Scale 1 1 2 ObjectInstance 'slab'");
    for (const char *integrator : {"volpath", "simplevolpath"})
        ExpectOfSky(Green(stretched, {integrator, 5, 256}), std::exp(-1.2), integrator);
}

TEST(MediaInPlaces, AMovingSlabShadesOnlyWhereItIs) {
    // A slab that leaves the view in the middle of the shutter: half of the time its light is weakened.
    const Objects slab = Objects()
                             .Add(kEvenSky + Absorbing(.6))
                             .Add("ActiveTransform EndTime Translate 0 100 0 ActiveTransform All")
                             .Add(Slab(-.5, .5, 50));
    ExpectOfSky(Green(slab, {"volpath", 5, 1024}), (1 + std::exp(-.6)) / 2, "", 1e-3);
}

TEST(MediaInPlaces, EmissionOfAGridOfTemperaturesIsThatOfQuadrature) {
    // Temperatures along the view's axis, in a box so wide that nothing changes across the view. It absorbs and emits.
    // Outside the voxels' middles stock and we interpolate towards 0, so the first and the last density are 0.
    auto text = [](const std::array<double, 6> &kelvins) {
        std::string temperatures, densities, ones;
        for (int i = 0; i < 24; ++i) {
            temperatures += fmt::format(" {}", kelvins[i / 4]);
            densities += i < 4 || i >= 20 ? " 0" : " 1";
            ones += " 1";
        }
        const std::string grid = "'string type' 'uniformgrid' 'integer nx' 2 'integer ny' 2 'integer nz' 6 ";
        return NamedMedium(grid + "'float density' [" + densities + " ] 'float temperature' [" + temperatures +
                           " ] 'float Lescale' [" + ones +
                           " ] 'rgb sigma_a' [1.2 1.2 1.2] 'rgb sigma_s' [0 0 0] 'point3 p0' [-3 -3 -1] 'point3 p1' "
                           "[3 3 1]") +
               FilledWith() + "Shape 'sphere' 'float radius' 2.9\n";
    };
    const Setting setting{"volpath", 5, 1024};
    const double kSigma = 1.2;
    struct Place {
        double density, kelvin;
    };
    auto at = [](const std::array<double, 6> &kelvins, double z) {
        const double v = std::clamp((z + 1) * 3 - .5, 0., 5.);
        const size_t low = std::min(size_t(v), size_t(4));
        const double f = v - double(low), d0 = low == 0 ? 0 : 1, d1 = low == 4 ? 0 : 1;
        return Place{d0 + (d1 - d0) * f, kelvins[low] + (kelvins[low + 1] - kelvins[low]) * f};
    };
    // The integral of the transmittance times absorption times `radiance` along the axis, from the camera's side.
    auto integral = [&](const std::array<double, 6> &kelvins, const auto &radiance) {
        double sum = 0, depth = 0;
        const int steps = 6000;
        for (int i = 0; i < steps; ++i) {
            const Place p = at(kelvins, 1 - (i + .5) / steps * 2);
            const double d = kSigma * p.density * 2 / steps;
            sum += radiance(p.kelvin) * std::exp(-depth - d / 2) * d;
            depth += d;
        }
        return sum;
    };
    // Pictures of even temperature give the radiance of black bodies in the units of the film. Between them its
    // logarithm is interpolated in 1 / temperature, where it is nearly straight.
    const std::vector<double> kelvins = {2800, 3100, 3500, 4000, 4500, 5000, 5500, 6000};
    std::vector<double> radiances;
    for (double k : kelvins) {
        const std::array<double, 6> even = {k, k, k, k, k, k};
        radiances.push_back(Green(text(even), setting).mean / integral(even, [](double) { return 1; }));
    }
    auto radiance = [&](double k) {
        size_t i = 0;
        while (i + 2 < kelvins.size() && kelvins[i + 1] < k) ++i;
        const double f = (1 / k - 1 / kelvins[i]) / (1 / kelvins[i + 1] - 1 / kelvins[i]);
        return std::exp((1 - f) * std::log(radiances[i]) + f * std::log(radiances[i + 1]));
    };
    const std::array<double, 6> temperatures = {5000, 5000, 2800, 3500, 6000, 6000};  // from z = -1 to 1
    const double expected = integral(temperatures, radiance);
    const RunningStatistics s = Green(text(temperatures), setting);
    EXPECT_LT(s.StandardError(), .01 * expected);
    EXPECT_LT(std::abs(s.mean / expected - 1), 4 * s.StandardError() / expected + .01) << s.mean << ' ' << expected;
}

/// A camera in a ball of fog, whose medium is current or not where a light is declared.
Image InFog(const std::string &integrator, const std::string &light, bool isCurrent, int maxDepth = 20) {
    const std::string parameters =
        integrator == "mlt" ? "'integer mutationsperpixel' 40 'integer bootstrapsamples' 9999" : "";
    Objects world;
    if (isCurrent) world.Add(light);
    world.Add("MediumInterface '' ''");
    if (!isCurrent) world.Add(light);
    world.Attribute("Material 'interface' MediumInterface 'm' ''", Objects().Shape("sphere"));
    world.Diffuse("1 1 1").Add("Translate 0 0 -.2").Sphere(.2);
    return RenderText(SceneText()
                          .Film(12, 12)
                          .Samples(16)
                          .Integrator(integrator, maxDepth, parameters)
                          .Head(Homogeneous("'rgb sigma_s' [1 1 1] 'rgb sigma_a' [0 0 0] 'float g' -.6"))
                          .Head("MediumInterface '' 'm'")
                          .LookAt("0 0 .5  0 0 0  0 1 0")
                          .Camera(60)
                          .World(world))
        .image;
}

TEST(MediaInPlaces, LightFromBeyondTheSceneArrivesThroughVacuum) {
    for (const char *integrator : {"volpath", "bdpt", "lightpath", "mlt"})
        for (const char *light : {"LightSource 'infinite' 'rgb L' [1 1 1]\n",
                                  "LightSource 'infinite' 'rgb L' [1 1 1] 'point3 portal' "
                                  "[-9 -9 4  9 -9 4  9 9 4  -9 9 4]\n",
                                  "LightSource 'distant' 'point3 from' [1 2 3]\n"})
            EXPECT_TRUE(SameBits(InFog(integrator, light, true), InFog(integrator, light, false)))
                << integrator << ' ' << light;
    // Other lights stand where they are declared.
    const std::string lamp = "LightSource 'point' 'point3 from' [0 .5 .3]\n";
    EXPECT_FALSE(SameBits(InFog("bdpt", lamp, true), InFog("bdpt", lamp, false)));
}

TEST(MediaInPlaces, AFurnaceAroundTheCameraIsInvisibleToLightPaths) {
    RunningStatistics expected;
    for (const char *integrator : {"volpath", "bdpt", "mlt"}) {
        const RunningStatistics s = ChannelStatistics(InFog(integrator, kEvenSky, true, 300));
        if (expected.n == 0) expected = s;
        EXPECT_LT(std::abs(s.mean / expected.mean - 1), .05) << integrator;
    }
}

}  // namespace
}  // namespace pbrt::test
