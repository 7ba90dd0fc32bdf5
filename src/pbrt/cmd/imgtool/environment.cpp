#include <cmath>

#include "pbrt/cmd/imgtool/commands.h"
#include "pbrt/cmd/imgtool/preetham_sky.h"
#include "pbrt/core/log.h"
#include "pbrt/math/frame.h"
#include "pbrt/math/warps.h"

namespace pbrt::imgtool {
namespace {

struct MakeequiareaOptions {
    std::string path, outfile;
    int resolution = 0;
};

/// Bilinear interpolation in a latitude-longitude image: columns wrap around, rows clamp at the poles.
class LatLong {
  public:
    explicit LatLong(const Image &image) : image_(image), size_(image.Resolution()) {}

    /// z up; the first column starts at +x towards +y, the first row is around +z.
    void Interpolate(const Vector3 &w, std::vector<Float> &values) const {
        Float phi = std::atan2(w.y, w.x);
        if (phi < 0) phi += 2 * Pi;
        const Float x = phi / (2 * Pi) * Float(size_.x) - Float(0.5);
        const Float y = std::acos(std::clamp(w.z, Float(-1), Float(1))) / Pi * Float(size_.y) - Float(0.5);
        const Float fx = std::floor(x), fy = std::floor(y);
        const int x0 = Column(int(fx)), x1 = Column(int(fx) + 1);
        const int y0 = Row(int(fy)), y1 = Row(int(fy) + 1);
        for (int c = 0; c < image_.ChannelCount(); ++c)
            values[c] += Lerp(y - fy, Lerp(x - fx, image_.Get({x0, y0}, c), image_.Get({x1, y0}, c)),
                              Lerp(x - fx, image_.Get({x0, y1}, c), image_.Get({x1, y1}, c)));
    }

  private:
    int Column(int x) const { return (x + size_.x) % size_.x; }
    int Row(int y) const { return std::clamp(y, 0, size_.y - 1); }
    const Image &image_;
    Point2i size_;
};

int Makeequiarea(const MakeequiareaOptions &o) {
    const ImageFile file = ReadAsFloat(o.path);
    const Point2i size = file.image.Resolution();
    if (file.metadata.fullResolution && *file.metadata.fullResolution != size)
        throw UserError("{}: has a part of an image of {} x {} pixels; the whole sphere is needed.", o.path,
                        file.metadata.fullResolution->x, file.metadata.fullResolution->y);
    if (size.x != 2 * size.y)
        LogWarning("{}: a latitude-longitude image is twice as wide as high; this one has {}.", o.path,
                   SizeText(file.image));
    const int resolution = o.resolution > 0 ? o.resolution : size.x;
    // If the result is smaller than the input's width, a pixel averages several look-ups, so that no light is lost.
    const int perSide = (size.x + resolution - 1) / resolution;
    const LatLong source(file.image);
    Image result(PixelFormat::Float, {resolution, resolution}, file.image.Channels());
    std::vector<Float> values(result.ChannelCount());
    ForEachPixel(result, [&](Point2i p) {
        std::fill(values.begin(), values.end(), Float(0));
        for (int j = 0; j < perSide; ++j)
            for (int i = 0; i < perSide; ++i) {
                const Point2 part((Float(i) + Float(0.5)) / Float(perSide), (Float(j) + Float(0.5)) / Float(perSide));
                source.Interpolate(EqualAreaSquareToSphere((Point2(p) + part) / Float(resolution)), values);
            }
        for (int c = 0; c < result.ChannelCount(); ++c) result.Set(p, c, values[c] / Float(perSide * perSide));
    });
    ImageMetadata metadata;
    metadata.colorSpace = file.metadata.colorSpace;
    WriteImage(o.outfile, result, metadata);
    return 0;
}

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
    const Rgb light = space.ToRgb(sky.SunRadiance()) * Float(share);
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
        const Vector3 w = EqualAreaSquareToSphere((Point2(p) + Point2(0.5f)) / Float(o.resolution));
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

void AddMakeequiarea(CLI::App &app, Action &action) {
    auto [command, o] = AddCommand(app, action, Makeequiarea, "makeequiarea",
                                   "Turn a latitude-longitude environment map into the equal-area square of pbrt-v4",
                                   "Example: imgtool makeequiarea meadow.hdr --resolution 1024 --outfile meadow.exr");
    AddFlags(command, {Flag("file", o.path, "Latitude-longitude image, up in the first row").Required(),
                       OutfileFlag(o.outfile, true),
                       {"--resolution", o.resolution, "Side of the result in pixels (default: width of the input)",
                        ValidRange{1, 1 << 15}}});
}

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
         Flag("--elevation", o.elevation, "Degrees of the sun above the horizon", ValidRange{0., 90.}).ShowDefault(),
         Flag("--turbidity", o.turbidity, "2: very clear, 10: haze", ValidRange{2., 10.}).ShowDefault(),
         Flag("--albedo", o.albedo, "Albedo of the ground, whose light brightens the sky (the ground is black)",
              ValidRange{0., 1.})
             .ShowDefault(),
         Flag("--resolution", o.resolution, "Side of the result in pixels", ValidRange{1, 1 << 14}).ShowDefault()});
}

}  // namespace pbrt::imgtool
