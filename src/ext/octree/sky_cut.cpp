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

double CostOf(double irradiance, double visible) { return irradiance * std::sqrt(visible); }

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
    double sum = 0;
    for (const Tile &t : tiles_)
        sum += CostOf(static_cast<double>(sky.At(t.number).irradiance), static_cast<double>(t.visible));
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
        if (tile.left == 0 && before<kSeenNear &&static_cast<double>(sky.At(tile.number).irradiance)> kMatters * sum) {
            const uint32_t key = SkyTiles::KeyOf(tile.number) + SkyTiles::KeyCount(tile.number) / 2;
            for (const SkyCut *cut : near)
                if (const Tile &other = cut->Holding(key); other.left > 0 && other.visible > kLit) before = kSeenNear;
        }
        tile.visible = std::clamp(static_cast<float>(Posterior(before, tile.traced, tile.left)), kLeast, 1.f);
    }
}

std::vector<uint32_t> SkyCut::ToDivide(const SkyTiles &sky) const {
    double sum = 0;
    for (const Tile &t : tiles_)
        sum += CostOf(static_cast<double>(sky.At(t.number).irradiance), static_cast<double>(t.visible));
    std::vector<std::pair<double, uint32_t>> gains;
    for (uint32_t i = 0; i < tiles_.size(); ++i) {
        const Tile &t = tiles_[i];
        if (t.traced < kRaysToDivide || SkyTile::LevelOf(t.number) >= SkyTile::kMaxLevel) continue;
        const auto e = static_cast<double>(sky.At(t.number).irradiance), v = static_cast<double>(t.visible);
        const double gain = CostOf(e, v) - e * v;
        if (gain > kGain * sum) gains.push_back({-gain, i});
    }
    std::sort(gains.begin(), gains.end());
    std::vector<uint32_t> order;
    for (const auto &[gain, i] : gains) order.push_back(i);
    if (order.size() > kMostDivided) order.resize(kMostDivided);
    return order;
}

void SkyCut::AppendChildren(const SkyTiles &sky, std::vector<uint32_t> *numbers) const {
    for (uint32_t i : ToDivide(sky))
        for (uint32_t c = 1; c <= 4; ++c) numbers->push_back(4 * tiles_[i].number + c);
}

double SkyCut::JoiningCosts(size_t first, const SkyTiles &sky) const {
    double light = 0, seen = 0, apart = 0;
    for (size_t i = first; i < first + 4; ++i) {
        const auto e = static_cast<double>(sky.At(tiles_[i].number).irradiance);
        const auto v = static_cast<double>(tiles_[i].visible);
        light += e;
        seen += e * v;
        apart += CostOf(e, v);
    }
    return light > 0 ? CostOf(light, seen / light) - apart : 0;
}

void SkyCut::Join(size_t first, const SkyTiles &sky) {
    Tile whole{(tiles_[first].number - 1) / 4, 0, 0, 0, 0};
    double light = 0, before = 0, visible = 0;
    for (size_t i = first; i < first + 4; ++i) {
        const double e = std::max(static_cast<double>(sky.At(tiles_[i].number).irradiance), 1e-30);
        light += e;
        before += e * static_cast<double>(tiles_[i].before);
        visible += e * static_cast<double>(tiles_[i].visible);
        whole.traced += tiles_[i].traced;
        whole.left += tiles_[i].left;
    }
    whole.before = static_cast<float>(before / light);
    whole.visible = static_cast<float>(visible / light);
    tiles_[first] = whole;
    tiles_.erase(tiles_.begin() + static_cast<std::ptrdiff_t>(first) + 1,
                 tiles_.begin() + static_cast<std::ptrdiff_t>(first) + 4);
}

void SkyCut::Adapt(const SkyTiles &sky, size_t most) {
    std::vector<uint32_t> divide = ToDivide(sky);
    auto gainOf = [&](uint32_t i) {
        const auto e = static_cast<double>(sky.At(tiles_[i].number).irradiance);
        return CostOf(e, static_cast<double>(tiles_[i].visible)) - e * static_cast<double>(tiles_[i].visible);
    };
    std::vector<double> gains;
    std::vector<uint32_t> numbers;
    for (uint32_t i : divide) {
        gains.push_back(gainOf(i));
        numbers.push_back(tiles_[i].number);
    }
    auto cheapest = [&](double *cost) {
        size_t best = tiles_.size();
        for (size_t i = 0; i + 3 < tiles_.size(); ++i) {
            const uint32_t n = tiles_[i].number;
            if (n % 4 != 1 || tiles_[i + 3].number != n + 3 || SkyTile::LevelOf(n) <= SkyTiles::kMinLevel) continue;
            // Not what is to be divided, nor what just was.
            bool isDivided = false;
            for (uint32_t d : numbers) isDivided |= (d >= n && d <= n + 3) || d == (n - 1) / 4;
            if (isDivided) continue;
            const double c = JoiningCosts(i, sky);
            if (best == tiles_.size() || c < *cost) {
                best = i;
                *cost = c;
            }
        }
        return best;
    };
    size_t done = 0;
    while (done < numbers.size()) {
        if (tiles_.size() + 3 <= most) {
            const auto at =
                std::find_if(tiles_.begin(), tiles_.end(), [&](const Tile &t) { return t.number == numbers[done]; });
            const Tile parent = *at;
            Tile children[4];
            for (uint32_t c = 0; c < 4; ++c)
                children[c] = {4 * parent.number + 1 + c, parent.visible, parent.visible, 0, 0};
            *at = children[0];
            tiles_.insert(at + 1, children + 1, children + 4);
            ++done;
            continue;
        }
        double cost = 0;
        const size_t join = cheapest(&cost);
        // What was just divided would be joined again if the gain were hardly more than the cost.
        if (join == tiles_.size() || 4 * cost > gains[done]) break;
        Join(join, sky);
    }
}

double SkyCut::GainOfDividingTheCell(const SkyTiles &sky) const {
    double gain = 0, sum = 0;
    for (const Tile &t : tiles_) {
        const auto e = static_cast<double>(sky.At(t.number).irradiance), v = static_cast<double>(t.visible);
        sum += CostOf(e, v);
        if (t.left > 0 && t.left < t.traced) gain += CostOf(e, v) - e * v;
    }
    return sum > 0 ? gain / sum : 0;
}

SkyCut SkyCut::Inherited() const {
    SkyCut part = *this;
    for (Tile &t : part.tiles_) t = {t.number, t.visible, t.visible, 0, 0};
    return part;
}

}  // namespace ext
