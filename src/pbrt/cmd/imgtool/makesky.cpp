#include <cmath>

#include "pbrt/cmd/imgtool/commands.h"
#include "pbrt/cmd/imgtool/preetham_sky.h"
#include "pbrt/math/frame.h"
#include "pbrt/math/warps.h"

namespace pbrt::imgtool {

namespace {

struct MakeskyOptions {
    std::string outfile;
    double albedo = 0.5, elevation = 10, turbidity = 3;
    int resolution = 2048;
};

/// Adds points uniform over the sun's disc, each with its share of the light, which preserves energy at any resolution.
/// Points below the horizon are skipped.
void AddSun(Image &image, const PreethamSky &sky, const ColorSpace &space) {
    constexpr int kPoints = 1 << 16;
    const double pixel = 4 * double(Pi) / (double(image.Resolution().x) * image.Resolution().y);
    const double cosRadius = std::cos(PreethamSky::SunRadius);
    const double share = 2 * double(Pi) * (1 - cosRadius) / pixel / kPoints;
    const Rgb light = space.ToRgb(sky.SunRadiance()) * static_cast<Float>(share);
    const Frame frame = Frame::FromZ(sky.SunDirection());
    constexpr double kTurn = 2.399963229728653;  // golden angle: sunflower spiral
    for (int i = 0; i < kPoints; ++i) {
        const double cosTheta = 1 - (1 - cosRadius) * (i + 0.5) / kPoints,
                     sinTheta = std::sqrt(1 - cosTheta * cosTheta);
        const Vector3 w =
            frame.FromLocal(Vector3(sinTheta * std::cos(kTurn * i), sinTheta * std::sin(kTurn * i), cosTheta));
        if (!(w.z > 0)) continue;
        const Point2 uv = EqualAreaSphereToSquare(Normalize(w));
        const Point2i p(glm::min(Point2i(uv * Point2(image.Resolution())), image.Resolution() - 1));
        SetRgb(image, p, {0, 1, 2}, GetRgb(image, p, {0, 1, 2}) + light);
    }
}

int Makesky(const MakeskyOptions &o) {
    const PreethamSky sky(o.elevation, o.turbidity, o.albedo);
    const ColorSpace &space = *ColorSpace::Find("aces2065-1");
    Image image(PixelFormat::Float, {o.resolution, o.resolution}, {"R", "G", "B"});
    ForEachPixel(image, [&](Point2i p) {
        const Vector3 w = EqualAreaSquareToSphere((Point2(p) + Point2(0.5f)) / static_cast<Float>(o.resolution));
        SetRgb(image, p, {0, 1, 2}, space.ToRgb(sky.Radiance(w)));
    });
    AddSun(image, sky, space);
    ImageMetadata metadata;
    metadata.colorSpace = &space;
    metadata.attributes["sky"] =
        fmt::format("Preetham 1999, elevation {}, turbidity {}, albedo {}", o.elevation, o.turbidity, o.albedo);
    WriteImage(o.outfile, image.ConvertTo(PixelFormat::Half), metadata);
    return 0;
}

}  // namespace

void AddMakesky(CLI::App &app, Action &action) {
    auto [command, o] =
        AddCommand(app, action, Makesky, "makesky", "Environment map of a clear sky with the sun",
                   "Equal-area square for LightSource \"infinite\", z up, sun towards +y, colours ACES2065-1.\n"
                   "Values are radiances in W / (m^2 sr nm): 1 is 72983 cd/m^2.\n"
                   "Model: Preetham, Shirley and Smits 1999; stock pbrt-v4 uses Hosek and Wilkie's.\n"
                   "Example: imgtool makesky --elevation 30 --outfile sky.exr");
    AddFlags(
        command,
        {OutfileFlag(o.outfile),
         Flag("--elevation", o.elevation, "Degrees of the sun above the horizon", CLI::Range(0., 90.)).ShowDefault(),
         Flag("--turbidity", o.turbidity, "2: very clear, 10: haze", CLI::Range(2., 10.)).ShowDefault(),
         Flag("--albedo", o.albedo, "Albedo of the ground, whose light brightens the sky (the ground is black)",
              CLI::Range(0., 1.))
             .ShowDefault(),
         Flag("--resolution", o.resolution, "Side of the result in pixels", CLI::Range(1, 1 << 14)).ShowDefault()});
}

}  // namespace pbrt::imgtool
