// Media in instances and in moving shapes, and the emission of media against quadrature.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "support/build_text.h"
#include "support/render_scene.h"
#include "support/statistics.h"

namespace pbrt::test {
namespace {

/// A view of 16 x 16 pixels from (0, 0, 3) towards the origin.
std::string View(const std::string &world, const std::string &integrator, int maxDepth, int samples) {
    return fmt::format(
        "LookAt 0 0 3  0 0 0  0 1 0\nCamera \"orthographic\" \"float screenwindow\" [-.5 .5 -.5 .5] \"float shutteropen\" 0 "
        "\"float shutterclose\" 1\nFilm \"rgb\" \"integer xresolution\" 16 \"integer yresolution\" 16 \"bool savefp16\" "
        "false\nPixelFilter \"box\"\nSampler \"independent\" \"integer pixelsamples\" {}\nIntegrator \"{}\" \"integer "
        "maxdepth\" {}\nWorldBegin\n{}",
        samples, integrator, maxDepth, world);
}

RunningStatistics Green(const std::string &text) {
    const Image image = RenderText(text).image;
    RunningStatistics s;
    for (int y = 0; y < image.Resolution().y; ++y)
        for (int x = 0; x < image.Resolution().x; ++x) s.Add(static_cast<double>(image.Get({x, y}, 1)));
    return s;
}

const std::string kSky = "LightSource \"infinite\" \"rgb L\" [1 1 1]\n";
const std::string kFog =
    "MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [0 0 0] \"rgb sigma_s\" [2 2 2] \"float g\" .4\n";
const std::string kFilled = "MediumInterface \"m\" \"\"\nMaterial \"interface\"\nShape \"sphere\"\n";

TEST(MediaInPlaces, AFurnaceInAnInstanceIsInvisible) {
    const double sky = Green(View(kSky, "volpath", 1000, 4)).mean;
    const std::string instances =
        kSky + kFog + "ObjectBegin \"ball\"\n" + kFilled +
        "ObjectEnd\nAttributeBegin\nTranslate .3 0 0\nScale .5 .7 .9\nObjectInstance \"ball\"\n"
        "AttributeEnd\nAttributeBegin\nTranslate -.3 .1 -3\nScale -.8 1 1\nObjectInstance "
        "\"ball\"\nAttributeEnd\n";
    const RunningStatistics s = Green(View(instances, "volpath", 1000, 128));
    EXPECT_LT(std::abs(s.mean / sky - 1), 4 * s.StandardError() / sky + 1e-4);
    EXPECT_LT(s.StandardError(), .01 * sky);
}

TEST(MediaInPlaces, AMovingFurnaceIsInvisible) {
    const double sky = Green(View(kSky, "volpath", 1000, 4)).mean;
    const std::string moving =
        kSky + kFog + "ActiveTransform EndTime\nTranslate .7 .2 0\nActiveTransform All\n" + kFilled;
    const RunningStatistics s = Green(View(moving, "volpath", 1000, 128));
    EXPECT_LT(std::abs(s.mean / sky - 1), 4 * s.StandardError() / sky + 1e-4);
    EXPECT_LT(s.StandardError(), .01 * sky);
}

TEST(MediaInPlaces, AnInstanceThatIsStretchedHoldsMoreOfTheMedium) {
    // What absorbs is per unit of length of the world, so a slab of thickness 1 that is stretched twofold takes 2
    // units.
    const std::string absorbing =
        "MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [.6 .6 .6] \"rgb sigma_s\" [0 0 0]\n";
    const std::string slab =
        "ObjectBegin \"slab\"\nMediumInterface \"m\" \"\"\nMaterial \"interface\"\n"
        "Shape \"bilinearmesh\" \"point3 P\" [-4 -4 .5  4 -4 .5  -4 4 .5  4 4 .5]\nReverseOrientation\n"
        "Shape \"bilinearmesh\" \"point3 P\" [-4 -4 -.5  4 -4 -.5  -4 4 -.5  4 4 -.5]\nObjectEnd\n";
    const double sky = Green(View(kSky, "volpath", 5, 4)).mean;
    for (const char *integrator : {"volpath", "simplevolpath"}) {
        const RunningStatistics s =
            Green(View(kSky + absorbing + slab + "Scale 1 1 2\nObjectInstance \"slab\"\n", integrator, 5, 256));
        EXPECT_LT(std::abs(s.mean / sky - std::exp(-1.2)), 4 * s.StandardError() / sky + 1e-4) << integrator;
        EXPECT_LT(s.StandardError(), .01 * sky);
    }
}

TEST(MediaInPlaces, AMovingSlabShadesOnlyWhereItIs) {
    // A slab that leaves the view in the middle of the shutter: half of the time its light is weakened.
    const std::string absorbing =
        "MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [.6 .6 .6] \"rgb sigma_s\" [0 0 0]\n";
    const std::string slab =
        "ActiveTransform EndTime\nTranslate 0 100 0\nActiveTransform All\nMediumInterface \"m\" \"\"\nMaterial "
        "\"interface\"\nShape \"bilinearmesh\" \"point3 P\" [-50 -50 .5  50 -50 .5  -50 50 .5  50 50 .5]\n"
        "ReverseOrientation\nShape \"bilinearmesh\" \"point3 P\" [-50 -50 -.5  50 -50 -.5  -50 50 -.5  50 50 -.5]\n";
    const double sky = Green(View(kSky, "volpath", 5, 4)).mean;
    const RunningStatistics s = Green(View(kSky + absorbing + slab, "volpath", 5, 1024));
    EXPECT_LT(std::abs(s.mean / sky - (1 + std::exp(-.6)) / 2), 4 * s.StandardError() / sky + 1e-3);
    EXPECT_LT(s.StandardError(), .01 * sky);
}

TEST(MediaInPlaces, AGridOfTemperaturesGlowsAsQuadratureSays) {
    // Temperatures along the view's axis, in a box so wide that nothing changes across the view. It absorbs and emits.
    // Outside the voxels' middles stock and we interpolate towards 0, so the first and the last density are 0.
    auto text = [](const std::array<double, 6> &kelvins) {
        std::string temperatures, densities;
        for (int i = 0; i < 24; ++i) {
            temperatures += fmt::format(" {}", kelvins[size_t(i / 4)]);
            densities += i < 4 || i >= 20 ? " 0" : " 1";
        }
        return View(
            "MakeNamedMedium \"m\" \"string type\" \"uniformgrid\" \"integer nx\" 2 \"integer ny\" 2 \"integer nz\" "
            "6 \"float density\" [" +
                densities + " ] \"float temperature\" [" + temperatures +
                " ] \"rgb sigma_a\" [1.2 1.2 1.2] \"rgb sigma_s\" [0 0 0] \"point3 p0\" [-3 -3 -1] \"point3 p1\" "
                "[3 3 1]\nMediumInterface \"m\" \"\"\nMaterial \"interface\"\nShape \"sphere\" \"float radius\" 2.9\n",
            "volpath", 5, 1024);
    };
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
        radiances.push_back(Green(text(even)).mean / integral(even, [](double) { return 1; }));
    }
    auto radiance = [&](double k) {
        size_t i = 0;
        while (i + 2 < kelvins.size() && kelvins[i + 1] < k) ++i;
        const double f = (1 / k - 1 / kelvins[i]) / (1 / kelvins[i + 1] - 1 / kelvins[i]);
        return std::exp((1 - f) * std::log(radiances[i]) + f * std::log(radiances[i + 1]));
    };
    const std::array<double, 6> temperatures = {5000, 5000, 2800, 3500, 6000, 6000};  // from z = -1 to 1
    const double expected = integral(temperatures, radiance);
    const RunningStatistics s = Green(text(temperatures));
    EXPECT_LT(s.StandardError(), .01 * expected);
    EXPECT_LT(std::abs(s.mean / expected - 1), 4 * s.StandardError() / expected + .01) << s.mean << ' ' << expected;
}

/// A camera in a ball of fog, whose medium is current or not where a light is declared.
Image InFog(const std::string &integrator, const std::string &light, bool isCurrent, int maxDepth = 20) {
    std::string text = fmt::format(
        "Film \"rgb\" \"integer xresolution\" 12 \"integer yresolution\" 12\nSampler \"independent\" "
        "\"integer pixelsamples\" 16\nIntegrator \"{}\" \"integer maxdepth\" {} {}\n"
        "MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"rgb sigma_s\" [1 1 1] "
        "\"rgb sigma_a\" [0 0 0] \"float g\" -.6\nMediumInterface \"\" \"m\"\n"
        "LookAt 0 0 .5  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 60\nWorldBegin\n",
        integrator, maxDepth,
        integrator == "mlt" ? "\"integer mutationsperpixel\" 40 \"integer bootstrapsamples\" 9999" : "");
    if (isCurrent) text += light;
    text += "MediumInterface \"\" \"\"\n";
    if (!isCurrent) text += light;
    return RenderText(text +
                      "AttributeBegin\nMaterial \"interface\"\nMediumInterface \"m\" \"\"\nShape \"sphere\"\n"
                      "AttributeEnd\nMaterial \"diffuse\" \"rgb reflectance\" [1 1 1]\nTranslate 0 0 -.2\n"
                      "Shape \"sphere\" \"float radius\" .2\n")
        .image;
}

TEST(MediaInPlaces, LightFromBeyondTheSceneArrivesThroughVacuum) {
    const auto bits = [](const Image &image) {
        const auto *data = static_cast<const char *>(image.Data());
        return std::string(data, data + image.Bytes());
    };
    for (const char *integrator : {"volpath", "bdpt", "lightpath", "mlt"}) {
        for (const char *light : {"LightSource \"infinite\" \"rgb L\" [1 1 1]\n",
                                  "LightSource \"infinite\" \"rgb L\" [1 1 1] \"point3 portal\" "
                                  "[-9 -9 4  9 -9 4  9 9 4  -9 9 4]\n",
                                  "LightSource \"distant\" \"point3 from\" [1 2 3]\n"}) {
            EXPECT_EQ(bits(InFog(integrator, light, true)), bits(InFog(integrator, light, false)))
                << integrator << ' ' << light;
        }
    }
    // Other lights stand where they are declared.
    const std::string lamp = "LightSource \"point\" \"point3 from\" [0 .5 .3]\n";
    EXPECT_NE(bits(InFog("bdpt", lamp, true)), bits(InFog("bdpt", lamp, false)));
}

TEST(MediaInPlaces, AFurnaceAroundTheCameraIsInvisibleToLightPaths) {
    const std::string sky = "LightSource \"infinite\" \"rgb L\" [1 1 1]\n";
    RunningStatistics expected;
    for (const char *integrator : {"volpath", "bdpt", "mlt"}) {
        const Image image = InFog(integrator, sky, true, 300);
        RunningStatistics s;
        for (int y = 0; y < 12; ++y)
            for (int x = 0; x < 12; ++x) s.Add(static_cast<double>(image.Get({x, y}, 1)));
        if (expected.n == 0) expected = s;
        EXPECT_LT(std::abs(s.mean / expected.mean - 1), .05) << integrator;
    }
}

}  // namespace
}  // namespace pbrt::test
