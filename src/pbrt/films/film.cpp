#include "pbrt/films/film.h"

#include <algorithm>
#include <cstring>
#include <istream>
#include <limits>
#include <ostream>

#include "pbrt/core/files.h"
#include "pbrt/core/log.h"
#include "pbrt/core/memory.h"
#include "pbrt/films/film_bounds.h"
#include "pbrt/images/picture_name.h"

namespace pbrt {

namespace {

constexpr Float kLargestHalf = 65504;

/// Said before the picture is rendered, not after.
void CheckFilename(FilmKind kind, const std::string &filename, const FileLoc &loc) {
    CheckPictureName(filename, loc);
    if (kind != FilmKind::Rgb && LowerExtension(filename) != ".exr")
        throw UserError(fmt::format("\"{}\": the channels of this film only fit into an .exr file.", filename), loc);
}

int GetExtent(const ParamSet &params, const char *name, int defaultValue, int divisor) {
    return std::max(1, params.GetInt(name, defaultValue, {1, 1 << 20}) / divisor);
}

}  // namespace

RgbFilm::RgbFilm(FilmKind kind, const ParamSet &params, const ColorSpace &outputSpace, Float exposureTime,
                 const FilmOverrides &overrides, DiagnosticSink &sink, double furtherBytes)
    : kind_(kind),
      space_(&outputSpace),
      sensor_(PixelSensor::Make(params, outputSpace, exposureTime)),
      outputFromSensor_(outputSpace.RgbFromXyz() * sensor_.XyzFromSensor()) {
    fullResolution_ = {GetExtent(params, "xresolution", 1280, overrides.resolutionDivisor),
                       GetExtent(params, "yresolution", 720, overrides.resolutionDivisor)};
    pixelBounds_ = ChoosePixelBounds(params, fullResolution_, overrides, sink);
    filename_ = params.GetString("filename", "pbrt.exr");
    if (!overrides.filename.empty()) filename_ = overrides.filename;
    CheckFilename(kind, filename_, overrides.filename.empty() ? params.LocOf("filename") : FileLoc());
    diagonal_ = params.GetFloat("diagonal", 35, Positive(1e6f));
    maxComponent_ = params.GetFloat("maxcomponentvalue", Infinity, Positive(std::numeric_limits<Float>::max()));
    half_ = params.GetBool("savefp16", true) && !overrides.fullFloat;
    // The sums, and the picture that is made of them when it is written.
    const double bytes = static_cast<double>(sizeof(Pixel) + 3 * sizeof(float)) + furtherBytes;
    RequireMemory(
        static_cast<double>(pixelBounds_.Area()) * bytes,
        fmt::format("{}: a picture of {} x {} pixels", params.What(), pixelBounds_.Width(), pixelBounds_.Height()),
        params.LocOf("xresolution"));
    pixels_.resize(static_cast<size_t>(pixelBounds_.Area()));
}

void RgbFilm::AddSample(Point2i pixel, const SampledSpectrum &L, const SampledWavelengths &lambda, Float weight) {
    PBRT_DCHECK(pixelBounds_.Contains(pixel));
    Vector3 sensor;
    if (Measure(L, lambda, weight, &sensor)) AddToSums(IndexOf(pixel), sensor, weight);
}

Image RgbFilm::ToImage() const { return MakeImage({}); }

Image RgbFilm::MakeImage(const std::vector<std::string> &furtherChannels) const {
    std::vector<std::string> channels = {"R", "G", "B"};
    channels.insert(channels.end(), furtherChannels.begin(), furtherChannels.end());
    Image image(half_ ? PixelFormat::Half : PixelFormat::Float, {pixelBounds_.Width(), pixelBounds_.Height()},
                channels, ColorEncoding{ColorEncoding::Kind::Linear});
    uint64_t clamped = 0;
    size_t i = 0;
    for (int y = 0; y < pixelBounds_.Height(); ++y)
        for (int x = 0; x < pixelBounds_.Width(); ++x) {
            const Pixel &sums = pixels_[i++];
            double scale = sums.weight != 0 ? 1 / sums.weight : 0;
            Vector3 sensor(static_cast<Float>(sums.sensor[0] * scale), static_cast<Float>(sums.sensor[1] * scale),
                           static_cast<Float>(sums.sensor[2] * scale));
            Rgb rgb = outputFromSensor_ * sensor;
            for (int c = 0; c < 3; ++c) {
                if (half_ && rgb[c] > kLargestHalf) {
                    rgb[c] = kLargestHalf;
                    ++clamped;
                }
                image.Set({x, y}, c, rgb[c]);
            }
        }
    if (clamped > 0)
        LogWarning(
            fmt::format("{} pixel values are above {}, the largest of half precision, and are cut to it; "
                        "\"bool savefp16\" false keeps them.",
                        clamped, kLargestHalf));
    if (rejected_ > 0)
        LogWarning(fmt::format("{} samples had infinite or not-a-number radiance and were dropped.", rejected_.load()));
    return image;
}

namespace {

struct StateHeader {
    char magic[8] = {'r', 'g', 'b', 'f', 'i', 'l', 'm', '1'};
    int32_t bounds[4] = {};
    uint64_t rejected = 0;
};

}  // namespace

void RgbFilm::SaveState(std::ostream &out) const {
    StateHeader header;
    const int bounds[4] = {pixelBounds_.low.x, pixelBounds_.low.y, pixelBounds_.high.x, pixelBounds_.high.y};
    std::copy(bounds, bounds + 4, header.bounds);
    header.rejected = rejected_;
    out.write(reinterpret_cast<const char *>(&header), sizeof(header));
    out.write(reinterpret_cast<const char *>(pixels_.data()),
              static_cast<std::streamsize>(pixels_.size() * sizeof(Pixel)));
}

void RgbFilm::LoadState(std::istream &in) {
    StateHeader header;
    const StateHeader expected;
    in.read(reinterpret_cast<char *>(&header), sizeof(header));
    const int bounds[4] = {pixelBounds_.low.x, pixelBounds_.low.y, pixelBounds_.high.x, pixelBounds_.high.y};
    if (!in || std::memcmp(header.magic, expected.magic, sizeof(header.magic)) != 0 ||
        !std::equal(bounds, bounds + 4, header.bounds))
        throw UserError("the saved state of a film is not of this film.");
    std::vector<Pixel> pixels(pixels_.size());
    in.read(reinterpret_cast<char *>(pixels.data()), static_cast<std::streamsize>(pixels.size() * sizeof(Pixel)));
    if (!in) throw UserError("the saved state of a film ends too early.");
    pixels_ = std::move(pixels);
    rejected_ = header.rejected;
}

ImageMetadata RgbFilm::Metadata() const {
    ImageMetadata metadata;
    metadata.pixelBounds = pixelBounds_;
    metadata.fullResolution = fullResolution_;
    metadata.colorSpace = space_;
    return metadata;
}

}  // namespace pbrt
