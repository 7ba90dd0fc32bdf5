#include "pbrt/samplers/random_samplers.h"

#include "pbrt/math/low_discrepancy.h"

namespace pbrt {

void StratifiedSampler::StartPixelSample(Point2i pixel, int sampleIndex, int dimension) {
    int round = sampleIndex / SamplesPerPixel();
    index_ = static_cast<uint32_t>(sampleIndex - round * SamplesPerPixel());
    pixelHash_ = Hash(pixel, seed_, round);
    dimension_ = dimension;
    stream_.Start(pixel, sampleIndex, dimension);
}

uint32_t StratifiedSampler::NextStratum(int dimensions) {
    uint64_t seed = pixelHash_ + static_cast<uint64_t>(dimension_);
    dimension_ += dimensions;
    return PermutationElement(index_, static_cast<uint32_t>(SamplesPerPixel()), seed);
}

Float StratifiedSampler::Get1D() {
    auto stratum = static_cast<Float>(NextStratum(1));
    return std::min((stratum + Offset()) / static_cast<Float>(SamplesPerPixel()), OneMinusEpsilon);
}

Point2 StratifiedSampler::Get2D() {
    auto stratum = static_cast<int>(NextStratum(2));
    int column = stratum % xSamples_, row = stratum / xSamples_;
    Float dx = Offset(), dy = Offset();
    return {std::min((static_cast<Float>(column) + dx) / static_cast<Float>(xSamples_), OneMinusEpsilon),
            std::min((static_cast<Float>(row) + dy) / static_cast<Float>(ySamples_), OneMinusEpsilon)};
}

}  // namespace pbrt
