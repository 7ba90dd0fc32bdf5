#include "ext/octree/sky_cut.h"

#include <algorithm>
#include <cmath>

namespace ext {

namespace {

/// A tile is divided after this many rays at least, and if that may gain this share of the cut's sum.
constexpr uint32_t kRaysToDivide = 16;
constexpr double kGain = 1e-3;

/// What is assumed of a tile that no ray from the cell found, but some from a cell nearby (which sees more than kLit of
/// it).
constexpr double kSeenNear = 0.25;
constexpr float kLit = 1e-3f;
/// This is done for tiles whose irradiance is more than this part of the cut's sum.
constexpr double kMatters = 0.02;

constexpr size_t kMostDivided = 12;  ///< tiles, at a time

double CostOf(double irradiance, double visible) { return irradiance * std::sqrt(visible); }

/// A tile's part of the sum that the cut keeps low.
double CostOf(const SkyTiles &sky, const SkyCut::Tile &tile) {
    return CostOf(static_cast<double>(sky.At(tile.number).irradiance), static_cast<double>(tile.visible));
}

/// What could be saved of it by telling the seen and the unseen parts of the tile apart.
double GainOf(const SkyTiles &sky, const SkyCut::Tile &tile) {
    const auto e = static_cast<double>(sky.At(tile.number).irradiance), v = static_cast<double>(tile.visible);
    return CostOf(e, v) - e * v;
}

double SumOf(const SkyTiles &sky, std::span<const SkyCut::Tile> tiles) {
    double sum = 0;
    for (const SkyCut::Tile &tile : tiles) sum += CostOf(sky, tile);
    return sum;
}

/// The mean of v after `traced` rays of which `left` left the scene, if it was `before`. Either v is 0, or it is any
/// value in [0, 1] with equal probability.
double Posterior(double before, double traced, double left) {
    const auto prior = static_cast<double>(SkyCut::kPrior);
    if (left > 0) return (left + prior * before) / (traced + prior);
    const double any = std::min(2 * before, 1.0), missed = any / (traced + 1);
    return missed / (1 - any + missed) / (traced + 2);
}

}  // namespace

const SkyCut::Tile &SkyCut::Holding(uint32_t key) const {
    const auto after = std::partition_point(tiles_.begin(), tiles_.end(),
                                            [&](const Tile &t) { return SkyTiles::KeyOf(t.number) <= key; });
    return *(after - 1);
}

void SkyCut::Estimate(const SkyTiles &sky, std::span<const SkyCut *const> near) {
    const double sum = SumOf(sky, tiles_);
    for (size_t i = 0; i < tiles_.size(); ++i) {
        Tile &tile = tiles_[i];
        double ratio = 1;
        if (static_cast<float>(tile.traced) < kEnough) {
            // The smallest region around the tile with enough rays, at most a quarter of the sky.
            uint32_t shift = 0;
            const uint32_t key = SkyTiles::KeyOf(tile.number);
            size_t begin = i, end = i + 1;
            double n = tile.traced, left = tile.left, expected = n * static_cast<double>(tile.before);
            auto take = [&](const Tile &t) {
                n += t.traced;
                left += t.left;
                expected += static_cast<double>(t.traced) * static_cast<double>(t.before);
            };
            while (n < static_cast<double>(kEnough) && shift < 2 * (SkyTile::kMaxLevel - 1)) {
                shift += 2;
                while (begin > 0 && SkyTiles::KeyOf(tiles_[begin - 1].number) >> shift == key >> shift)
                    take(tiles_[--begin]);
                while (end < tiles_.size() && SkyTiles::KeyOf(tiles_[end].number) >> shift == key >> shift)
                    take(tiles_[end++]);
            }
            const auto prior = static_cast<double>(kPrior);
            if (expected > 0) ratio = (n * left / expected + prior) / (n + prior);
        }
        double before = static_cast<double>(tile.before) * ratio;
        // Only tiles that would matter if they were seen are worth the look around.
        const bool matters = static_cast<double>(sky.At(tile.number).irradiance) > kMatters * sum;
        if (tile.left == 0 && before < kSeenNear && matters) {
            const uint32_t key = SkyTiles::KeyOf(tile.number) + SkyTiles::KeyCount(tile.number) / 2;
            for (const SkyCut *cut : near)
                if (const Tile &other = cut->Holding(key); other.left > 0 && other.visible > kLit) before = kSeenNear;
        }
        tile.visible = std::clamp(static_cast<float>(Posterior(before, tile.traced, tile.left)), kLeast, 1.f);
    }
}

std::vector<SkyCut::Division> SkyCut::ToDivide(const SkyTiles &sky) const {
    const double sum = SumOf(sky, tiles_);
    std::vector<Division> divisions;
    for (const Tile &t : tiles_) {
        if (t.traced < kRaysToDivide || SkyTile::LevelOf(t.number) >= SkyTile::kMaxLevel) continue;
        if (const double gain = GainOf(sky, t); gain > kGain * sum) divisions.push_back({gain, t.number});
    }
    std::stable_sort(divisions.begin(), divisions.end(),
                     [](const Division &a, const Division &b) { return a.gain > b.gain; });
    if (divisions.size() > kMostDivided) divisions.resize(kMostDivided);
    return divisions;
}

void SkyCut::AppendChildren(const SkyTiles &sky, std::vector<uint32_t> *numbers) const {
    for (const Division &d : ToDivide(sky))
        for (uint32_t c = 1; c <= 4; ++c) numbers->push_back(4 * d.number + c);
}

void SkyCut::Divide(uint32_t number) {
    const auto at = std::find_if(tiles_.begin(), tiles_.end(), [&](const Tile &t) { return t.number == number; });
    const float visible = at->visible;
    Tile children[4];
    for (uint32_t c = 0; c < 4; ++c) children[c] = {4 * number + 1 + c, visible, visible, 0, 0};
    *at = children[0];
    tiles_.insert(at + 1, children + 1, children + 4);
}

std::optional<SkyCut::Joining> SkyCut::CheapestToJoin(const SkyTiles &sky, std::span<const Division> divisions) const {
    std::optional<Joining> best;
    for (size_t i = 0; i + 3 < tiles_.size(); ++i) {
        const uint32_t n = tiles_[i].number;
        if (n % 4 != 1 || tiles_[i + 3].number != n + 3 || SkyTile::LevelOf(n) <= SkyTiles::kMinLevel) continue;
        // Not what is to be divided, nor what just was.
        if (std::any_of(divisions.begin(), divisions.end(), [n](const Division &d) {
                return (d.number >= n && d.number <= n + 3) || d.number == (n - 1) / 4;
            }))
            continue;
        double light = 0, seen = 0, apart = 0;
        for (const Tile &t : std::span(tiles_).subspan(i, 4)) {
            const auto e = static_cast<double>(sky.At(t.number).irradiance);
            light += e;
            seen += e * static_cast<double>(t.visible);
            apart += CostOf(sky, t);
        }
        const double cost = light > 0 ? CostOf(light, seen / light) - apart : 0;
        if (!best || cost < best->cost) best = {cost, i};
    }
    return best;
}

void SkyCut::Join(size_t first, const SkyTiles &sky) {
    Tile whole{(tiles_[first].number - 1) / 4, 0, 0, 0, 0};
    double light = 0, before = 0, visible = 0;
    for (size_t i = first; i < first + 4; ++i) {
        const double e = std::max(static_cast<double>(sky.At(tiles_[i].number).irradiance), 1e-30);
        light += e;
        before += e * static_cast<double>(tiles_[i].before);
        visible += e * static_cast<double>(tiles_[i].visible);
        whole.Add(tiles_[i].traced, tiles_[i].left);
    }
    whole.before = static_cast<float>(before / light);
    whole.visible = static_cast<float>(visible / light);
    tiles_[first] = whole;
    tiles_.erase(tiles_.begin() + static_cast<std::ptrdiff_t>(first) + 1,
                 tiles_.begin() + static_cast<std::ptrdiff_t>(first) + 4);
}

void SkyCut::Adapt(const SkyTiles &sky, size_t most) {
    const std::vector<Division> divisions = ToDivide(sky);
    for (const Division &division : divisions) {
        while (tiles_.size() + 3 > most) {
            const std::optional<Joining> join = CheapestToJoin(sky, divisions);
            // What was just divided would be joined again if the gain were hardly more than the cost.
            if (!join || 4 * join->cost > division.gain) return;
            Join(join->first, sky);
        }
        Divide(division.number);
    }
}

double SkyCut::GainOfDividingTheCell(const SkyTiles &sky) const {
    double gain = 0;
    for (const Tile &t : tiles_)
        if (t.left > 0 && t.left < t.traced) gain += GainOf(sky, t);
    const double sum = SumOf(sky, tiles_);
    return sum > 0 ? gain / sum : 0;
}

SkyCut SkyCut::Inherited() const {
    SkyCut part = *this;
    for (Tile &t : part.tiles_) t = {t.number, t.visible, t.visible, 0, 0};
    return part;
}

}  // namespace ext
