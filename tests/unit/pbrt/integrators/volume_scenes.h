#pragma once
#include <gtest/gtest.h>

#include "pbrt/core/parallel.h"
#include "support/render_scene.h"
#include "support/scene_text.h"

// Shapes and media around the origin, seen from (0, 0, 3).
namespace pbrt::test {

struct Setting {
    std::string integrator = "volpath";
    int maxDepth = 100, samples = 64;
    std::string lightSampler = "bvh";
    std::string beforeCamera{};       ///< such as the medium that the camera stands in
    std::string samplerParameters{};  ///< of the light sampler
};

/// A view of 16 x 16 pixels.
inline std::string VolumeScene(const std::string &world, const Setting &s = {}) {
    std::string parameters;
    if (s.integrator == "volpath") parameters = "'string lightsampler' '" + s.lightSampler + "' " + s.samplerParameters;
    if (s.integrator == "mlt")
        parameters = fmt::format("'integer mutationsperpixel' {} 'integer bootstrapsamples' 4000", s.samples);
    return SceneText()
        .Head(s.beforeCamera)
        .LookAt("0 0 3  0 0 0  0 1 0")
        .Camera("orthographic", "'float screenwindow' [-.5 .5 -.5 .5]")
        .Film(16, 16)
        .Filter("box")
        .Samples(s.samples)
        .Integrator(s.integrator, s.maxDepth, parameters)
        .World(world);
}
/// The statistics of the green channel of a view.
inline RunningStatistics Green(const std::string &world, const Setting &setting = {}) {
    return ChannelStatistics(RenderText(VolumeScene(world, setting)).image);
}

inline const std::string kEvenSky = Objects().Sky("1 1 1");

/// Expects a mean of `expected` times that of the even sky, and little noise.
inline void ExpectOfSky(const RunningStatistics &s, double expected, const std::string &what = "",
                        double allowed = 1e-4, double maxNoise = .01) {
    static const double sky = Green(kEvenSky).mean;
    EXPECT_LT(std::abs(s.mean / sky - expected), 4 * s.StandardError() / sky + allowed) << what;
    EXPECT_LT(s.StandardError(), maxNoise * sky) << what << ": too noisy to compare";
}

inline void ExpectSameForThreads(const std::string &scene) {
    const auto render = [&](int threads) {
        ThreadLimit limit(threads);
        return RenderText(scene).image;
    };
    EXPECT_TRUE(SameBits(render(1), render(3)));
}

inline std::string NamedMedium(const std::string &parameters, const std::string &name = "m") {
    return "MakeNamedMedium '" + name + "' " + parameters + "\n";
}
inline std::string Homogeneous(const std::string &parameters, const std::string &name = "m") {
    return NamedMedium("'string type' 'homogeneous' " + parameters, name);
}
/// A medium that scatters nothing.
inline std::string Absorbing(double sigma, const std::string &name = "m", const std::string &parameters = "") {
    return Homogeneous(fmt::format("'rgb sigma_a' [{0} {0} {0}] 'rgb sigma_s' [0 0 0] ", sigma) + parameters, name);
}
/// The shapes that follow contain the medium.
inline std::string FilledWith(const std::string &medium = "m") {
    return "MediumInterface '" + medium + "' ''\nMaterial 'interface'\n";
}
/// The surfaces at two heights between which the medium is.
inline Objects Slab(double low, double high, double halfWidth = 9, const std::string &medium = "m") {
    const auto level = [&](double z) {
        return fmt::format("-{1} -{1} {0}  {1} -{1} {0}  -{1} {1} {0}  {1} {1} {0}", z, halfWidth);
    };
    const std::string turn = "ReverseOrientation";
    return Objects().Add(FilledWith(medium)).Quad(level(high)).Add(turn).Quad(level(low)).Add(turn);
}

}  // namespace pbrt::test
