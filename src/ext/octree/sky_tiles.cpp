#include "ext/octree/sky_tiles.h"

#include <algorithm>
#include <queue>

#include "pbrt/core/parallel.h"

namespace ext {

SkyTiles::SkyTiles(const LightTable &lights, size_t sky) : lights_(&lights), sky_(sky) {
    lights[Sky()].Whole().PrepareTiles();
    whole_.isFar = true;
    constexpr uint32_t kLevel = 3;
    std::vector<uint32_t> numbers(size_t(1) << 2 * kLevel);
    for (uint32_t i = 0; i < numbers.size(); ++i) numbers[i] = SkyTile::FirstOf(kLevel) + i;
    Know(numbers);
    for (uint32_t number : numbers) {
        whole_.m0 += At(number).irradiance;
        whole_.m1 += At(number).irradiance * At(number).direction;
    }
}

void SkyTiles::Know(std::span<const uint32_t> numbers) {
    std::vector<uint32_t> unknown;
    for (uint32_t n : numbers)
        if (tiles_.try_emplace(n).second) unknown.push_back(n);
    std::vector<Tile> measured(unknown.size());
    ParallelFor(static_cast<int64_t>(unknown.size()), 8, [&](int64_t begin, int64_t end) {
        for (auto i = static_cast<size_t>(begin); i < static_cast<size_t>(end); ++i) measured[i] = Measure(unknown[i]);
    });
    for (size_t i = 0; i < unknown.size(); ++i) tiles_[unknown[i]] = measured[i];
}

bool SkyTiles::KnowsAround(uint32_t number) const {
    for (;; number = (number - 1) / 4) {
        const uint32_t first = number - (number - 1) % 4;
        for (uint32_t n = first; n < first + 4; ++n)
            if (!tiles_.contains(n)) return false;
        if (SkyTile::LevelOf(number) <= kMinLevel) return true;
    }
}

SkyTiles::Tile SkyTiles::Measure(uint32_t number) const {
    Tile tile;
    // Samples follow the pixels' mean of R, G, B, so what they find over their density differs by the colour only.
    constexpr int kSide = 4;
    const LightPart light = (*lights_)[IdOf(number)];
    double sum = 0;
    for (int i = 0; i < kSide * kSide; ++i) {
        const Point2 u((static_cast<Float>(i % kSide) + 0.5f) / kSide, (static_cast<Float>(i / kSide) + 0.5f) / kSide);
        std::optional<LightLiSample> s = light.SampleLi({}, u, SampledWavelengths::WholeRange(), true);
        if (!s || !(s->pdf > 0)) continue;
        const double value = RootMeanSquare(s->L) / double(s->pdf);
        if (std::isfinite(value)) sum += value;
    }
    tile.irradiance = static_cast<Float>(std::min(sum / (kSide * kSide) / lights_->Unit(), 1e30));

    // The cone must hold the whole tile: its border is followed in steps.
    constexpr int kSteps = 16;
    const Bounds2 square = SkyTile::Of(number).Square();
    const Point2 corners[4] = {square.low, {square.high.x, square.low.y}, square.high, {square.low.x, square.high.y}};
    const Light &whole = light.Whole();
    tile.direction = whole.DirectionAt((square.low + square.high) * Float(0.5));
    Float least = 1;
    for (int i = 0; i < 4 * kSteps; ++i) {
        const Float t = static_cast<Float>(i % kSteps) / kSteps;
        const Point2 a = corners[i / kSteps], b = corners[(i / kSteps + 1) % 4];
        least = std::min(least, Dot(tile.direction, whole.DirectionAt(a + t * (b - a))));
    }
    // A margin for the steps' gaps and for rounding.
    tile.sine = std::min(SafeSqrt(1 - Sqr(std::max(least, Float(0)))) * Float(1.1) + Float(1e-3), Float(1));
    return tile;
}

std::vector<uint32_t> SkyTiles::FirstCut(size_t count) {
    const double light = std::max(static_cast<double>(whole_.m0), 1e-30);
    std::priority_queue<std::pair<double, uint32_t>> open;
    std::vector<uint32_t> cut;
    auto add = [&](uint32_t number) {
        const uint32_t level = SkyTile::LevelOf(number);
        const double importance =
            static_cast<double>(At(number).irradiance) / light + 1 / static_cast<double>(1u << 2 * level);
        if (level < SkyTile::kMaxLevel)
            open.push({importance, ~number});
        else
            cut.push_back(number);
    };
    auto addFour = [&](uint32_t first) {
        const uint32_t four[] = {first, first + 1, first + 2, first + 3};
        Know(four);
        for (uint32_t number : four) add(number);
    };
    for (uint32_t i = 0; i < 1u << 2 * kMinLevel; i += 4) addFour(SkyTile::FirstOf(kMinLevel) + i);
    while (!open.empty() && cut.size() + open.size() + 3 <= count) {
        const uint32_t number = ~open.top().second;
        open.pop();
        addFour(4 * number + 1);
    }
    for (; !open.empty(); open.pop()) cut.push_back(~open.top().second);
    std::sort(cut.begin(), cut.end(), [](uint32_t a, uint32_t b) { return KeyOf(a) < KeyOf(b); });
    return cut;
}

}  // namespace ext
