#include "pbrt/films/sensor_sums.h"

#include <limits>

#include "pbrt/core/log.h"
#include "pbrt/core/parallel.h"

namespace pbrt {

namespace {

constexpr Float kMaxHalf = 65504;

}  // namespace

SensorSums::SensorSums(const FilmParams &params, const ParamSet &set, const FilmFrame &frame, Float exposureTime)
    : SensorSums(frame, params.maxComponentValue,
                 PixelSensor::Make(params.sensor, set, *frame.outputSpace, exposureTime)) {}

SensorSums::SensorSums(const FilmFrame &frame, Float maxComponent, const PixelSensor &sensor)
    : resolution_(frame.pixelBounds.high - frame.pixelBounds.low), fullPixels_(frame.FullPixels()), half_(frame.half),
      maxComponent_(maxComponent), sensor_(sensor),
      outputFromSensor_(frame.outputSpace->RgbFromXyz() * sensor_.XyzFromSensor()), pixels_(frame.PixelCount()) {}

SensorSums SensorSums::MakeEmpty(const FilmFrame &frame) const { return {frame, maxComponent_, sensor_}; }

bool SensorSums::AddSplat(size_t pixel, const SampledSpectrum &L, const SampledWavelengths &lambda, Float weight) {
    const std::optional<Vector3> sensor = Measure(L, lambda, weight);
    if (!sensor) return false;
    const glm::dvec3 weighted = double(weight) * glm::dvec3(*sensor);
    for (int c = 0; c < 3; ++c)
        if (!FixedSum::Holds(weighted[c])) {
            Reject();
            return false;
        }
    for (int c = 0; c < 3; ++c) splats_.Add(3 * pixel + static_cast<size_t>(c), weighted[c]);
    return true;
}

Rgb SensorSums::ColorOf(size_t pixel) const {
    const Pixel &sums = pixels_[pixel];
    const double weight = sums.weight.Value(), scale = weight != 0 ? 1 / weight : 0;
    Vector3 sensor;
    for (int c = 0; c < 3; ++c) {
        double mean = sums.sensor[c].Value() * scale;
        if (splats_.AreExpected()) mean += splats_.Sum(3 * pixel + static_cast<size_t>(c)) * SplatScale();
        sensor[c] = static_cast<Float>(mean);
    }
    return outputFromSensor_ * sensor;
}

Image SensorSums::Colors() const {
    Image image(PixelFormat::Float, resolution_, {"R", "G", "B"}, ColorEncoding{ColorEncoding::Kind::Linear});
    auto *values = static_cast<float *>(image.Data());
    ParallelFor(static_cast<int64_t>(pixels_.size()), 1 << 12, [&](int64_t begin, int64_t end) {
        for (auto i = static_cast<size_t>(begin); i < static_cast<size_t>(end); ++i) {
            const Rgb rgb = ColorOf(i);
            for (size_t c = 0; c < 3; ++c) values[3 * i + c] = rgb[static_cast<int>(c)];
        }
    });
    return image;
}

Image SensorSums::MakeImage(const std::vector<std::string> &furtherChannels) const {
    std::vector<std::string> channels = {"R", "G", "B"};
    channels.insert(channels.end(), furtherChannels.begin(), furtherChannels.end());
    Image image(half_ ? PixelFormat::Half : PixelFormat::Float, resolution_, channels,
                ColorEncoding{ColorEncoding::Kind::Linear});
    uint64_t clamped = 0;
    size_t i = 0;
    for (int y = 0; y < resolution_.y; ++y)
        for (int x = 0; x < resolution_.x; ++x, ++i) {
            Rgb rgb = ColorOf(i);
            for (int c = 0; c < 3; ++c) {
                if (half_ && rgb[c] > kMaxHalf) {
                    rgb[c] = kMaxHalf;
                    ++clamped;
                }
                image.Set({x, y}, c, rgb[c]);
            }
        }
    if (clamped > 0)
        LogWarning(
            fmt::format("{} pixel values are above {}, the largest of half precision, and are cut to it; "
                        "\"bool savefp16\" false keeps them.",
                        clamped, kMaxHalf));
    if (counts_.rejected > 0)
        LogWarning(
            fmt::format("{} samples were dropped: their radiance is not a number, or too large for single "
                        "precision ({:.2g}).",
                        counts_.rejected, std::numeric_limits<Float>::max()));
    return image;
}

void SensorSums::AppendBlocks(std::vector<StateBlock> &blocks) const {
    blocks.push_back(MakeStateBlock("sensor", std::span(pixels_)));
    blocks.push_back(splats_.Block("sensor splats"));
    blocks.push_back(MakeStateBlock("counts", std::span(&counts_, 1)));
}

}  // namespace pbrt
