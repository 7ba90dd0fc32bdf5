#include "pbrt/math/sobol.h"

#include <vector>

#include <boost/random/sobol.hpp>

#include "pbrt/core/error.h"

namespace pbrt {

const uint32_t *SobolMatrices() {
    // Boost's engine is in Gray code order: the n-th point has index n ^ (n >> 1), so index 2^c is n = 2^(c+1) - 1. It
    // omits the origin, so its own count is one less. With 64-digit fractions it has 64 columns; 32 digits of 52
    // columns are kept.
    static const std::vector<uint32_t> matrices = [] {
        boost::random::sobol_engine<uint64_t, 64> engine(SobolDimensions);
        std::vector<uint32_t> made(size_t(SobolDimensions) * SobolIndexBits);
        for (size_t c = 0; c < SobolIndexBits; ++c) {
            engine.seed((uint64_t(2) << c) - 2);
            for (size_t d = 0; d < SobolDimensions; ++d) made[d * SobolIndexBits + c] = uint32_t(engine() >> 32);
        }
        return made;
    }();
    return matrices.data();
}

const uint32_t *SobolTables() {
    static const std::vector<uint32_t> tables = [] {
        constexpr size_t kRows = SobolIndexBits / 4 * 16;
        std::vector<uint32_t> made(kRows * SobolTableRow);
        const uint32_t *columns = SobolMatrices();
        for (size_t row = 0; row < kRows; ++row)
            for (size_t d = 0; d < SobolDimensions; ++d)
                made[row * SobolTableRow + d] = SobolBits(columns + d * SobolIndexBits + row / 16 * 4, row % 16);
        return made;
    }();
    return tables.data();
}

SobolPixelIndex::SobolPixelIndex(int log2Resolution) : log2Resolution_(log2Resolution) {
    PBRT_CHECK_MSG(log2Resolution >= 0 && 2 * log2Resolution <= SobolIndexBits, "log2Resolution = {}", log2Resolution);
    int m = log2Resolution, n = 2 * m;
    if (m == 0) return;
    const uint32_t *first = SobolMatrices(), *second = first + SobolIndexBits;
    auto pixelOf = [&](int column) {
        return uint64_t(first[column] >> (32 - m)) | uint64_t(second[column] >> (32 - m)) << m;
    };

    // Gauss-Jordan over GF(2) on columns: `image` becomes the identity, `source` the combined low index bits.
    std::vector<uint64_t> image(n), source(n);
    for (int c = 0; c < n; ++c) {
        image[c] = pixelOf(c);
        source[c] = uint64_t(1) << c;
    }
    for (size_t row = 0; row < size_t(n); ++row) {
        size_t pivot = row;
        while (pivot < image.size() && !(image[pivot] >> row & 1)) ++pivot;
        PBRT_CHECK(pivot < image.size());
        std::swap(image[row], image[pivot]);
        std::swap(source[row], source[pivot]);
        for (size_t c = 0; c < image.size(); ++c)
            if (c != row && (image[c] >> row & 1)) {
                image[c] ^= image[row];
                source[c] ^= source[row];
            }
    }
    std::copy(source.begin(), source.end(), pixelColumns_.begin());
    for (int c = n; c < SobolIndexBits; ++c)
        for (uint64_t bits = pixelOf(c); bits; bits &= bits - 1) frameColumns_[c - n] ^= pixelColumns_[IndexOf(bits)];
}

}  // namespace pbrt
