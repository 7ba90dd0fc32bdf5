#include "pbrt/films/rgb_film.h"

#include <limits>

#include "pbrt/core/log.h"
#include "pbrt/core/parallel.h"

namespace pbrt {
namespace {

constexpr Float kMaxHalf = 65504;
constexpr double kBytesPerPixel = 4 * sizeof(PreciseSum) + 3 * sizeof(float);

}  // namespace

RgbFilm::RgbFilm(const std::string &kind, const FilmParams &params, const ParamSet &set, const FilmRequest &request,
                 double furtherBytes)
    : RgbFilm{kind, request.Frame(params, set, furtherBytes > 0, kBytesPerPixel + furtherBytes),
              params.maxComponentValue,
              PixelSensor::Make(params.sensor, set, request.context.outputSpace, request.context.exposureTime)} {}

RgbFilm::RgbFilm(const std::string &kind, const FilmFrame &frame, Float maxComponent, const PixelSensor &sensor)
    : Film(kind, frame), maxComponent_(maxComponent), sensor_(sensor),
      outputFromSensor_(frame.outputSpace->RgbFromXyz() * sensor_.XyzFromSensor()), pixels_(frame.PixelCount()) {}

std::unique_ptr<Film> RgbFilm::MakeRgbFilm() const {
    FilmFrame frame = Frame();
    frame.half = false;
    return std::unique_ptr<Film>(new RgbFilm("rgb", frame, maxComponent_, sensor_));
}

void RgbFilm::AddSample(const FilmSample &sample) {
    if (std::optional<Vector3> sensor = Measure(sample.L, sample.lambda, sample.weight))
        Add(Frame().IndexOf(sample.pixel), *sensor, sample.weight);
}

bool RgbFilm::AddSensorSplat(size_t pixel, const SampledSpectrum &L, const SampledWavelengths &lambda, Float weight) {
    const std::optional<Vector3> sensor = Measure(L, lambda, weight);
    if (!sensor) return false;
    const glm::dvec3 weighted = double(weight) * glm::dvec3(*sensor);
    for (int c = 0; c < 3; ++c)
        if (!FixedSum::Holds(weighted[c])) {
            Reject();
            return false;
        }
    for (int c = 0; c < 3; ++c) splats_.Add(3 * pixel + c, weighted[c]);
    return true;
}

Rgb RgbFilm::ColorOf(size_t pixel) const {
    const Pixel &sums = pixels_[pixel];
    const double weight = sums.weight.Value(), scale = weight != 0 ? 1 / weight : 0;
    Vector3 sensor;
    for (int c = 0; c < 3; ++c) {
        double mean = sums.sensor[c].Value() * scale;
        if (splats_.AreExpected()) mean += splats_.Sum(3 * pixel + c) * SplatScale();
        sensor[c] = Float(mean);
    }
    return outputFromSensor_ * sensor;
}

Image RgbFilm::Colors() const {
    Image image(PixelFormat::Float, Resolution(), {"R", "G", "B"}, ColorEncoding{ColorEncoding::Kind::Linear});
    auto *values = static_cast<float *>(image.Data());
    ParallelFor(pixels_.size(), 1 << 12, [&](int64_t begin, int64_t end) {
        for (int64_t i = begin; i < end; ++i) {
            const Rgb rgb = ColorOf(i);
            for (int c = 0; c < 3; ++c) values[3 * i + c] = rgb[c];
        }
    });
    return image;
}

Image RgbFilm::MakeImage(const std::vector<std::string> &furtherChannels) const {
    std::vector<std::string> channels = {"R", "G", "B"};
    channels.insert(channels.end(), furtherChannels.begin(), furtherChannels.end());
    const bool half = Frame().half;
    Image image(half ? PixelFormat::Half : PixelFormat::Float, Resolution(), channels,
                ColorEncoding{ColorEncoding::Kind::Linear});
    uint64_t clamped = 0;
    size_t i = 0;
    ForEachPixel(image, [&](Point2i p) {
        Rgb rgb = ColorOf(i++);
        for (int c = 0; c < 3; ++c) {
            if (half && rgb[c] > kMaxHalf) {
                rgb[c] = kMaxHalf;
                ++clamped;
            }
            image.Set(p, c, rgb[c]);
        }
    });
    if (clamped > 0)
        LogWarning(
            "{} pixel values are above {}, the largest of half precision, and are cut to it; "
            "\"bool savefp16\" false keeps them.",
            clamped, kMaxHalf);
    if (counts_.rejected > 0)
        LogWarning(
            "{} samples were dropped: their radiance is not a number, or too large for single precision ({:.2g}).",
            counts_.rejected, std::numeric_limits<Float>::max());
    return image;
}

std::vector<StateBlock> RgbFilm::Blocks() const {
    return {MakeStateBlock("sensor", std::span(pixels_)), splats_.Block("sensor splats"),
            MakeStateBlock("counts", std::span(&counts_, 1))};
}

}  // namespace pbrt
