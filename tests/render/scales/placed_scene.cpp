#include "placed_scene.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pbrt/math/statistics.h"
#include "support/render_scene.h"

namespace pbrt::test {

std::string Placement::Name() const {
    std::string name = fmt::format("scale {:g}", scale);
    if (offset != std::array<double, 3>{0, 0, 0})
        name += fmt::format(" at {:g} {:g} {:g}", offset[0], offset[1], offset[2]);
    if (instanced) name += ", instanced";
    return renderCoordSys.empty() ? name : name + " in " + renderCoordSys;
}

std::string Placement::Points(std::initializer_list<double> coordinates) const {
    std::string text;
    size_t axis = 0;
    for (const double x : coordinates) text += fmt::format(" {:.9g}", x * scale + offset[axis++ % 3]);
    return text;
}

std::string Placement::Intensity(double I) const { return fmt::format("{0:.9g} {0:.9g} {0:.9g}", I * scale * scale); }

std::vector<ScaleIntegrator> AllIntegrators(const Placement &at, int mutations) {
    return {
        {"path"},
        {"volpath"},
        {"simplepath"},
        {"bdpt"},
        {"lightpath", "", 4 * kScaleSamples},
        {"mlt", fmt::format("'integer mutationsperpixel' {} 'integer bootstrapsamples' {}", mutations, 64 * mutations),
         kScaleSamples, 12},
        {"sppm", "'integer photonsperiteration' 2000 'float radius' " + at.Length(0.1)}};
}

std::string ViewText(const Placement &at, const ScaleIntegrator &integrator, std::initializer_list<double> fromToUp,
                     double fov, int maxDepth, const std::string &world) {
    const std::vector<double> v(fromToUp);
    const std::string &space = at.renderCoordSys;
    return SceneText()
        .Head(space.empty() ? "" : "Option 'rendercoordsys' '" + space + "'")
        .LookAt(fmt::format("{} {}  {} {} {}", at.Points({v[0], v[1], v[2]}), at.Points({v[3], v[4], v[5]}), v[6], v[7],
                            v[8]))
        .Camera(fov)
        .Filter("box")
        .Film(kScaleResolution, kScaleResolution, "'bool savefp16' false")
        .Samples(integrator.samples)
        .Integrator(integrator.name, maxDepth, integrator.parameters)
        .World(world);
}

std::vector<Image> RenderSeeds(const std::string &text, int runs, int firstSeed) {
    std::vector<Image> images;
    for (int run = 0; run < runs; ++run) {
        BuildOptions options;
        options.seed = firstSeed + run;
        images.push_back(RenderText(text, options).image);
    }
    return images;
}

namespace {

constexpr int kTile = 4;
constexpr double kFalseAlarm = 1e-4;  ///< of one comparison, if the seeds were not fixed

/// Means of R, G and B over tiles; the last one is that of the image.
std::vector<double> GreyTiles(const Image &image) {
    const std::vector<double> rgb = TileMeans(image, kTile);
    std::vector<double> grey;
    double sum = 0;
    for (size_t i = 0; i < rgb.size(); i += 3) {
        grey.push_back((rgb[i] + rgb[i + 1] + rgb[i + 2]) / 3);
        sum += grey.back();
    }
    grey.push_back(sum / double(grey.size()));
    return grey;
}

}  // namespace

double MeanOf(const Image &image) { return GreyTiles(image).back(); }

ScaleDifference CompareRuns(const std::vector<Image> &ours, const std::vector<Image> &reference, double allowed) {
    std::vector<RunningStatistics> differences;
    RunningStatistics mean;
    for (size_t run = 0; run < ours.size(); ++run) {
        const std::vector<double> a = GreyTiles(ours[run]), b = GreyTiles(reference[run]);
        differences.resize(a.size());
        for (size_t i = 0; i < a.size(); ++i) differences[i].Add(a[i] - b[i]);
        mean.Add(b.back());
    }
    ScaleDifference out;
    out.level = SidakAlpha(kFalseAlarm, differences.size());
    for (size_t i = 0; i < differences.size(); ++i) {
        const bool isImage = i + 1 == differences.size();
        const RunningStatistics &d = differences[i];
        const double relative = d.mean / mean.mean, error = d.StandardError() / mean.mean;
        if (isImage) {
            out.mean = relative;
            out.meanError = error;
        } else if (std::abs(relative) > std::abs(out.worstTile)) {
            out.worstTile = relative;
        }
        const double off = std::abs(relative) - allowed * (isImage ? 1 : 4);
        if (std::isnan(off)) out.worstP = 0;
        if (!(off > 0)) continue;
        const double dof = double(d.n - 1);
        out.worstP = std::min(out.worstP, error > 0 ? StudentTwoSidedP(off / error, dof) : 0.0);
    }
    return out;
}

std::string ScaleDifference::Text() const {
    return fmt::format("mean {:+.3f} +- {:.3f} %, worst tile {:+.2f} %, p {:.2g}", 100 * mean, 100 * meanError,
                       100 * worstTile, worstP);
}

void ExpectSame(const std::string &name, const std::vector<Image> &ours, const std::vector<Image> &reference,
                double allowed) {
    const ScaleDifference d = CompareRuns(ours, reference, allowed);
    std::printf("%s: %s\n", name.c_str(), d.Text().c_str());
    EXPECT_TRUE(d.Agrees()) << name << ": " << d.Text();
}

}  // namespace pbrt::test
