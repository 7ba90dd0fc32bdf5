#pragma once
#include <algorithm>
#include <array>
#include <initializer_list>
#include <string>
#include <vector>

#include "pbrt/images/image.h"
#include "support/scene_text.h"

namespace pbrt::test {

/// Where a test scene lies: world position = offset + scale * position in the scene's own units.
struct Placement {
    double scale = 1;
    std::array<double, 3> offset{0, 0, 0};
    std::string renderCoordSys{};  ///< empty: the default
    bool instanced = false;        ///< for tests that place shapes by an instance

    std::string Name() const;
    /// A length as scene files write it.
    std::string Length(double length) const { return fmt::format("{:.9g}", length * scale); }
    /// Points (x, y, z, x, y, z, ...) as scene files write them.
    std::string Points(std::initializer_list<double> coordinates) const;
    /// Intensity of a point light that gives the same irradiance at every scale.
    std::string Intensity(double I) const;
};

constexpr int kScaleSamples = 16;
/// One integrator and what it needs.
struct ScaleIntegrator {
    std::string name;
    std::string parameters{};
    int samples = kScaleSamples;
    int minRuns = 0;  ///< of few samples each, where noise does not cancel: errors of more runs are better known

    int Runs(int runs) const { return std::max(runs, minRuns); }
};
/// All that render direct and indirect light of area, point and infinite lights. `mutations`: of mlt, per pixel.
std::vector<ScaleIntegrator> AllIntegrators(const Placement &at, int mutations = 8);

constexpr int kScaleResolution = 16, kScaleRuns = 5;
/// Of the corners of a quad.
constexpr const char *kTwoTriangles = "0 1 2 1 3 2";
/// A view of kScaleResolution^2 pixels.
std::string ViewText(const Placement &at, const ScaleIntegrator &integrator, std::initializer_list<double> fromToUp,
                     double fov, int maxDepth, const std::string &world);

/// Renders a scene text with several seeds.
std::vector<Image> RenderSeeds(const std::string &text, int runs, int firstSeed = 1);

/// Differences between two sets of renders, run by run: equal seeds give nearly equal noise, which cancels.
struct ScaleDifference {
    double mean = 0, meanError = 0;  ///< of the image, relative to the reference's mean
    double worstTile = 0;            ///< difference of a tile of 4 x 4 pixels, relative to the reference's mean
    double worstP = 1;               ///< of Student's t for the image and all tiles, beyond `allowed`
    double level = 0;                ///< Sidak's, for each of them
    bool Agrees() const { return worstP > level; }
    std::string Text() const;
};
/// `allowed`: relative to the reference's mean, for the image; tiles may differ by four times as much.
ScaleDifference CompareRuns(const std::vector<Image> &ours, const std::vector<Image> &reference, double allowed);
/// Prints the difference and expects it to be noise, or allowed.
void ExpectSame(const std::string &name, const std::vector<Image> &ours, const std::vector<Image> &reference,
                double allowed);

/// Mean of R, G and B over an image.
double MeanOf(const Image &image);

}  // namespace pbrt::test
