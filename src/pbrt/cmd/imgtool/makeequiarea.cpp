#include <cmath>

#include "pbrt/cmd/imgtool/commands.h"
#include "pbrt/core/log.h"
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
        const Float x = phi / (2 * Pi) * static_cast<Float>(size_.x) - Float(0.5);
        const Float y = std::acos(std::clamp(w.z, Float(-1), Float(1))) / Pi * static_cast<Float>(size_.y) - Float(0.5);
        const Float fx = std::floor(x), fy = std::floor(y);
        const int x0 = Column(static_cast<int>(fx)), x1 = Column(static_cast<int>(fx) + 1);
        const int y0 = Row(static_cast<int>(fy)), y1 = Row(static_cast<int>(fy) + 1);
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
        throw UserError(fmt::format("{}: has a part of a picture of {} x {} pixels; the whole sphere is needed.",
                                    o.path, file.metadata.fullResolution->x, file.metadata.fullResolution->y));
    if (size.x != 2 * size.y)
        LogWarning(fmt::format("{}: a latitude-longitude image is twice as wide as high; this one has {}.", o.path,
                               SizeText(file.image)));
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
                const Point2 part((static_cast<Float>(i) + Float(0.5)) / static_cast<Float>(perSide),
                                  (static_cast<Float>(j) + Float(0.5)) / static_cast<Float>(perSide));
                source.Interpolate(EqualAreaSquareToSphere((Point2(p) + part) / static_cast<Float>(resolution)),
                                   values);
            }
        for (int c = 0; c < result.ChannelCount(); ++c)
            result.Set(p, c, values[c] / static_cast<Float>(perSide * perSide));
    });
    ImageMetadata metadata;
    metadata.colorSpace = file.metadata.colorSpace;
    WriteImage(o.outfile, result, metadata);
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
                        CLI::Range(1, 1 << 15)}});
}

}  // namespace pbrt::imgtool
