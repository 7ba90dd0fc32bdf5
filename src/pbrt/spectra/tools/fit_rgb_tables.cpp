// Fits and writes the table of one colour space: fit_rgb_tables <space> <file>. Layout in rgb_primaries.h.
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "pbrt/core/error.h"
#include "pbrt/core/files.h"
#include "pbrt/core/parallel.h"
#include "pbrt/spectra/tools/sigmoid_fit.h"

using namespace pbrt;

namespace {

constexpr size_t kRes = RgbTableResolution;

/// Fits all scales of one pair of ratios outwards from a middle one, each starting from its neighbour's result.
void FitColumn(const SigmoidFit &fit, size_t slab, size_t yIndex, size_t xIndex, std::vector<float> &table) {
    const auto scales = RgbTableScales();
    constexpr size_t kStart = kRes / 5;
    double x = double(xIndex) / double(kRes - 1), y = double(yIndex) / double(kRes - 1);
    auto fitOne = [&](size_t scale, double c[3]) {
        double rgb[3], b = double(scales[scale]);
        rgb[slab] = b;
        rgb[(slab + 1) % 3] = x * b;
        rgb[(slab + 2) % 3] = y * b;
        fit.Fit(rgb, c);
        float *entry = &table[RgbTableIndex(slab, scale, yIndex, xIndex)];
        SigmoidFit::ToNanometres(c, entry);
        PBRT_CHECK_MSG(std::isfinite(entry[0] + entry[1] + entry[2]), "rgb {} {} {}", rgb[0], rgb[1], rgb[2]);
    };
    double c[3] = {0, 0, 0};
    fitOne(kStart, c);
    double down[3] = {c[0], c[1], c[2]};
    for (size_t scale = kStart + 1; scale < kRes; ++scale) fitOne(scale, c);
    for (size_t scale = kStart; scale-- > 0;) fitOne(scale, down);
}

const RgbPrimaries &FindSpace(const std::string &name) {
    std::vector<std::string> names;
    for (const RgbPrimaries &space : KnownRgbPrimaries()) {
        if (space.name == name) return space;
        names.push_back(space.name);
    }
    throw UserError("no colour space \"{}\"; {}.", name, ListChoices(name, names));
}

}  // namespace

int main(int argc, char **argv) try {
    if (argc != 3) throw UserError("usage: fit_rgb_tables <space> <file>");
    SigmoidFit fit(FindSpace(argv[1]));
    std::vector<float> table(RgbTableFloats);
    ParallelForEach(3 * kRes, [&](int64_t row) {
        auto slab = size_t(row) / kRes, y = size_t(row) % kRes;
        for (size_t x = 0; x < kRes; ++x) FitColumn(fit, slab, y, x, table);
    });
    WriteFile(argv[2], {reinterpret_cast<const char *>(table.data()), table.size() * sizeof(float)});
    return 0;
} catch (const UserError &e) {
    std::fprintf(stderr, "fit_rgb_tables: %s\n", e.what());
    return 1;
}
