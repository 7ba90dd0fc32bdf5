#include "pbrt/math/sobol.h"

#include <boost/random/detail/sobol_table.hpp>
#include <vector>

#include "pbrt/core/error.h"

namespace pbrt {

namespace {

std::vector<uint32_t> MakeSobolMatrices() {
    using Table = boost::random::detail::qrng_tables::sobol;
    std::vector<uint32_t> matrices(static_cast<size_t>(SobolDimensions) * SobolIndexBits, 0);
    for (int c = 0; c < 32; ++c) matrices[static_cast<size_t>(c)] = 0x80000000u >> c;
    for (size_t d = 1; d < SobolDimensions; ++d) {
        uint32_t *column = &matrices[d * SobolIndexBits];
        // Table row d - 1: the primitive polynomial (bit k = coefficient of x^k) and the initial odd integers m.
        uint32_t polynomial = Table::polynomial(d - 1);
        int degree = std::bit_width(polynomial) - 1;
        for (int c = 0; c < SobolIndexBits; ++c) {
            if (c < degree) {
                column[c] = uint32_t(Table::minit(d - 1, static_cast<size_t>(c))) << (31 - c);
                continue;
            }
            // As binary fractions v_c = m_c / 2^(c+1): the recurrence shifts only the term `degree` places back.
            uint32_t v = column[c - degree] ^ (column[c - degree] >> degree);
            for (int k = 1; k < degree; ++k)
                if (polynomial >> (degree - k) & 1) v ^= column[c - k];
            column[c] = v;
        }
    }
    return matrices;
}

std::vector<uint32_t> MakeSobolTables() {
    std::vector<uint32_t> tables(static_cast<size_t>(SobolDimensions) * SobolTableStride);
    const uint32_t *columns = SobolMatrices();  // 52 a dimension, so that each four make one table
    for (size_t t = 0; t < tables.size(); ++t) tables[t] = SobolBits(columns + t / 16 * 4, t % 16);
    return tables;
}

}  // namespace

const uint32_t *SobolMatrices() {
    static const std::vector<uint32_t> matrices = MakeSobolMatrices();
    return matrices.data();
}

const uint32_t *SobolTables() {
    static const std::vector<uint32_t> tables = MakeSobolTables();
    return tables.data();
}

SobolPixelIndex::SobolPixelIndex(int log2Resolution) : log2Resolution_(log2Resolution) {
    PBRT_CHECK_MSG(log2Resolution >= 0 && log2Resolution <= 16, "log2Resolution = {}", log2Resolution);
    int m = log2Resolution, n = 2 * m;
    if (m == 0) return;
    const uint32_t *first = SobolMatrices(), *second = first + SobolIndexBits;
    auto pixelOf = [&](int column) {
        return uint64_t(first[column] >> (32 - m)) | uint64_t(second[column] >> (32 - m)) << m;
    };

    // Gauss-Jordan over GF(2) on columns: `image` turns into unit vectors while `source` records which low index bits
    // were added up to get them.
    std::vector<uint64_t> image(static_cast<size_t>(n)), source(static_cast<size_t>(n));
    for (int c = 0; c < n; ++c) {
        image[static_cast<size_t>(c)] = pixelOf(c);
        source[static_cast<size_t>(c)] = uint64_t(1) << c;
    }
    for (size_t row = 0; row < static_cast<size_t>(n); ++row) {
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
        for (uint64_t bits = pixelOf(c); bits; bits &= bits - 1)
            frameColumns_[static_cast<size_t>(c - n)] ^= pixelColumns_[IndexOf(bits)];
}

}  // namespace pbrt
