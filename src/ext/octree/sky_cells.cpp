#include "ext/octree/sky_cells.h"

#include <algorithm>
#include <cmath>

#include "pbrt/core/parallel.h"

namespace ext {

namespace {
/// A cell is open if it sees more than this share of every sky.
constexpr Float kOpen = 0.97f;

Float VisibleShare(const SkyTiles &sky, const SkyCut &cut) {
    double light = 0, seenLight = 0, seen = 0;
    for (const SkyCut::Tile &t : cut.Tiles()) {
        const auto e = static_cast<double>(sky.At(t.number).irradiance), v = static_cast<double>(t.visible);
        light += e;
        seenLight += e * v;
        seen += v / static_cast<double>(1u << 2 * SkyTile::LevelOf(t.number));
    }
    return light > 0 ? static_cast<Float>(std::min(seenLight / light, seen)) : Float(0);
}
}  // namespace

SkyCells::SkyCells(const Bounds3 &bounds, std::span<const std::vector<uint32_t>> cuts, float visible,
                   const Settings &settings)
    : settings_(settings), octree_(bounds), cells_(1) {
    cells_[0].box = bounds;
    for (const std::vector<uint32_t> &numbers : cuts) cells_[0].cuts.emplace_back(numbers, visible);
}

size_t SkyCells::LaneOf(const Row &row, size_t k, uint32_t key) const {
    const auto begin = keys_.begin() + row.first[k] * kLanes, end = keys_.begin() + row.first[k + 1] * kLanes;
    // The last tile that does not begin behind the key; unused lanes are at the end and count as behind.
    return static_cast<size_t>(std::upper_bound(begin, end, key) - keys_.begin()) - 1;
}

void SkyCells::TakeCounts() {
    if (!counts_) return;
    std::vector<uint64_t> traced(cells_.size(), 0), left(cells_.size(), 0);
    ParallelFor(static_cast<int64_t>(cells_.size()), 32, [&](int64_t begin, int64_t end) {
        for (auto c = static_cast<size_t>(begin); c < static_cast<size_t>(end); ++c) {
            for (size_t k = 0; k < cells_[c].cuts.size(); ++k) {
                SkyCut &cut = cells_[c].cuts[k];
                const size_t first = rows_[c].first[k] * kLanes;
                for (size_t t = 0; t < cut.Tiles().size(); ++t) {
                    std::atomic<uint64_t> *const counts = counts_.get() + 2 * (first + t);
                    const uint64_t h = counts[1].exchange(0, std::memory_order_relaxed);
                    const uint64_t n = counts[0].exchange(0, std::memory_order_relaxed) + h;
                    if (n == 0) continue;
                    cut.Add(t, n, h);
                    traced[c] += n;
                    left[c] += h;
                }
            }
            cells_[c].rays += traced[c];
            cells_[c].fresh += traced[c];
        }
    });
    for (size_t c = 0; c < cells_.size(); ++c) {
        traced_ += traced[c];
        left_ += left[c];
    }
}

void SkyCells::Adapt(std::span<SkyTiles> skies) {
    auto forEachCell = [&](auto &&visit) {
        ParallelFor(static_cast<int64_t>(cells_.size()), 32, [&](int64_t begin, int64_t end) {
            for (auto c = static_cast<size_t>(begin); c < static_cast<size_t>(end); ++c)
                if (cells_[c].fresh >= settings_.freshRays) visit(c);
        });
    };
    std::vector<std::vector<uint32_t>> children(cells_.size());
    // Cells look at each other, so all of them see what was known before.
    const std::vector<Cell> before = cells_;
    for (size_t k = 0; k < skies.size(); ++k) {
        forEachCell([&](size_t c) {
            std::vector<const SkyCut *> near;
            const Bounds3 &box = cells_[c].box;
            for (int corner = 0; corner < 14; ++corner) {
                // The corners and the middles of the sides, a little outside.
                Vector3 to(0);
                if (corner < 8)
                    to = {corner & 1 ? 1.f : -1.f, corner & 2 ? 1.f : -1.f, corner & 4 ? 1.f : -1.f};
                else
                    to[(corner - 8) / 2] = corner % 2 ? 1.f : -1.f;
                const uint32_t other = octree_.Row(box.Center() + to * (box.high - box.low) * Float(0.55));
                if (other != c) near.push_back(&before[other].cuts[k]);
            }
            cells_[c].cuts[k].Estimate(skies[k], near);
            children[c].clear();
            cells_[c].cuts[k].AppendChildren(skies[k], &children[c]);
        });
        for (const std::vector<uint32_t> &numbers : children) skies[k].Know(numbers);
        forEachCell([&](size_t c) { cells_[c].cuts[k].Adapt(skies[k], settings_.tiles); });
    }
    forEachCell([&](size_t c) { cells_[c].fresh = 0; });
}

uint32_t SkyCells::AddCellLike(uint32_t cell) {
    cells_.push_back(cells_[cell]);
    cells_.back().rays = cells_.back().fresh = 0;
    return static_cast<uint32_t>(cells_.size() - 1);
}

void SkyCells::Split(uint32_t node, uint32_t cell) {
    const uint32_t first = octree_.Split(node);
    for (SkyCut &cut : cells_[cell].cuts) cut = cut.Inherited();
    cells_[cell].rays = cells_[cell].fresh = 0;
    const Bounds3 box = cells_[cell].box;
    for (uint32_t c = 0; c < 8; ++c) {
        const uint32_t child = c == 0 ? cell : AddCellLike(cell);
        octree_.SetLeaf(first + c, child);
        const Vector3 half = (box.high - box.low) / Float(2);
        const Point3 low = box.low + half * Vector3(c & 1 ? 1.f : 0.f, c & 2 ? 1.f : 0.f, c & 4 ? 1.f : 0.f);
        cells_[child].box = Bounds3(low, low + half);
    }
}

void SkyCells::Divide(std::span<const SkyTiles> skies) {
    struct Leaf {
        uint32_t node, cell;
        double worth;
    };
    std::vector<Leaf> leaves;
    octree_.ForEachLeaf([&](uint32_t node, uint32_t cell, int depth) {
        if (cells_[cell].rays >= settings_.leastRays && depth < CellOctree::MaxDepth) leaves.push_back({node, cell, 0});
    });
    ParallelFor(static_cast<int64_t>(leaves.size()), 32, [&](int64_t begin, int64_t end) {
        for (auto i = static_cast<size_t>(begin); i < static_cast<size_t>(end); ++i) {
            double gain = 0;
            for (size_t k = 0; k < skies.size(); ++k)
                gain = std::max(gain, cells_[leaves[i].cell].cuts[k].GainOfDividingTheCell(skies[k]));
            leaves[i].worth = static_cast<double>(cells_[leaves[i].cell].rays) * gain;
        }
    });
    std::erase_if(leaves, [&](const Leaf &l) { return l.worth < settings_.worthDividing; });
    std::sort(leaves.begin(), leaves.end(),
              [&](const Leaf &a, const Leaf &b) { return a.worth != b.worth ? a.worth > b.worth : a.node < b.node; });
    for (const Leaf &leaf : leaves) {
        if (cells_.size() + 7 > settings_.mostCells) break;
        Split(leaf.node, leaf.cell);
    }
}

void SkyCells::DivideAround(std::span<const Point3> points, std::span<SkyTiles> skies) {
    // The top grid first: until now its nodes are one cell.
    const Bounds3 whole = cells_[0].box;
    for (uint32_t top = 0; top < CellOctree::TopCount; ++top) {
        const uint32_t cell = top == 0 ? 0 : AddCellLike(0);
        octree_.SetLeaf(top, cell);
        const Vector3 side = (whole.high - whole.low) / static_cast<Float>(CellOctree::TopCells);
        const Point3 low = whole.low + side * Vector3(top & 3, top >> 2 & 3, top >> 4);
        cells_[cell].box = Bounds3(low, low + side);
    }
    for (bool any = true; any && cells_.size() < settings_.mostCells;) {
        any = false;
        std::vector<std::pair<uint32_t, size_t>> inCell(cells_.size(), {0, 0});  // node, points
        for (const Point3 &p : points) {
            const CellOctree::Cell cell = octree_.CellAt(p);
            inCell[cell.row].first = cell.node;
            inCell[cell.row].second += cell.depth < CellOctree::MaxDepth;
        }
        for (uint32_t cell = 0; cell < inCell.size() && cells_.size() + 7 <= settings_.mostCells; ++cell) {
            if (inCell[cell].second <= settings_.manyPoints) continue;
            Split(inCell[cell].first, cell);
            any = true;
        }
    }
    for (Cell &cell : cells_)
        for (SkyCut &cut : cell.cuts) cut = cut.Inherited();
    MakeRows(skies);
}

void SkyCells::Learn(std::span<SkyTiles> skies, bool divides) {
    TakeCounts();
    Adapt(skies);
    if (divides) Divide(skies);
    MakeRows(skies);
}

void SkyCells::MakeRows(std::span<const SkyTiles> skies) {
    rows_.assign(cells_.size(), {});
    visible_.assign(cells_.size(), {});
    uint32_t packets = 0;
    tileCount_ = 0;
    for (size_t c = 0; c < cells_.size(); ++c)
        for (size_t k = 0; k < kMaxSkies; ++k) {
            rows_[c].first[k] = packets;
            if (k < skies.size()) {
                const size_t tiles = cells_[c].cuts[k].Tiles().size();
                tileCount_ += tiles;
                packets += static_cast<uint32_t>((tiles + kLanes - 1) / kLanes);
            }
            rows_[c].first[k + 1] = packets;
        }
    packets_.assign(packets, {});
    numbers_.assign(packets * kLanes, 0);
    keys_.assign(packets * kLanes, kNoKey);
    halves_.assign(packets * kLanes, 0);
    counts_.reset(new std::atomic<uint64_t>[2 * packets * kLanes]());
    ParallelFor(static_cast<int64_t>(cells_.size()), 32, [&](int64_t begin, int64_t end) {
        for (auto c = static_cast<size_t>(begin); c < static_cast<size_t>(end); ++c) {
            bool isOpen = true;
            for (size_t k = 0; k < skies.size(); ++k) {
                const size_t firstLane = rows_[c].first[k] * kLanes;
                size_t lane = firstLane;
                double light = 0, learned = 0;
                for (const SkyCut::Tile &t : cells_[c].cuts[k].Tiles()) {
                    const auto e = static_cast<double>(skies[k].At(t.number).irradiance);
                    light += e;
                    learned += e * std::sqrt(static_cast<double>(t.visible));
                }
                const auto share = static_cast<double>(settings_.floor);
                const auto floor =
                    static_cast<Float>(light > 0 ? share / (1 - std::min(share, 0.999)) * learned / light : 0);
                for (const SkyCut::Tile &t : cells_[c].cuts[k].Tiles()) {
                    const SkyTiles::Tile &tile = skies[k].At(t.number);
                    Packet &p = packets_[lane / kLanes];
                    const size_t i = lane % kLanes;
                    p.x[i] = tile.direction.x;
                    p.y[i] = tile.direction.y;
                    p.z[i] = tile.direction.z;
                    p.sine[i] = tile.sine;
                    p.quarterInvSine[i] = Float(0.25) / tile.sine;
                    p.weight[i] = tile.irradiance * (std::sqrt(t.visible) + floor);
                    numbers_[lane] = t.number;
                    keys_[lane] = SkyTiles::KeyOf(t.number);
                    ++lane;
                }
                rows_[c].tiles[k] = static_cast<uint16_t>(lane - firstLane);
                MakeHalves(firstLane, lane - firstLane);
                visible_[c][k] = VisibleShare(skies[k], cells_[c].cuts[k]);
                isOpen = isOpen && visible_[c][k] > kOpen;
            }
            rows_[c].isOpen = isOpen;
        }
    });
}

void SkyCells::MakeHalves(size_t firstLane, size_t tiles) {
    // Tiles are sorted by keys, whose highest bit is that of y.
    struct Part {
        size_t node, first, count;
        uint32_t key, keys;  ///< the part's tiles have the keys [key, key + keys)
    };
    std::vector<Part> parts{{0, firstLane, tiles, 0, SkyTiles::KeyCount(0)}};
    while (!parts.empty()) {
        const Part p = parts.back();
        parts.pop_back();
        if (p.count == 1) continue;
        const auto begin = keys_.begin() + static_cast<std::ptrdiff_t>(p.first);
        const uint32_t middle = p.key + p.keys / 2;
        const auto m =
            static_cast<size_t>(std::lower_bound(begin, begin + static_cast<std::ptrdiff_t>(p.count), middle) - begin);
        halves_[firstLane + p.node] = static_cast<uint8_t>(m);
        parts.push_back({p.node + 1, p.first, m, p.key, p.keys / 2});
        parts.push_back({p.node + m, p.first + m, p.count - m, middle, p.keys / 2});
    }
}

void SkyCells::EndLearning() {
    counts_.reset();
    for (Cell &cell : cells_) cell.cuts = {};
}

double SkyCells::OpenShare() const {
    const auto open = std::count_if(rows_.begin(), rows_.end(), [](const Row &r) { return r.isOpen; });
    return rows_.empty() ? 0 : static_cast<double>(open) / static_cast<double>(rows_.size());
}

size_t SkyCells::Bytes() const {
    size_t bytes = octree_.Bytes() + rows_.capacity() * sizeof(Row) + packets_.capacity() * sizeof(Packet) +
                   (numbers_.capacity() + keys_.capacity()) * sizeof(uint32_t) + halves_.capacity() +
                   visible_.capacity() * sizeof(visible_[0]) + cells_.capacity() * sizeof(Cell);
    bytes += CountCount() * sizeof(uint64_t);
    for (const Cell &cell : cells_)
        for (const SkyCut &cut : cell.cuts) bytes += cut.Tiles().capacity() * sizeof(SkyCut::Tile);
    return bytes;
}

}  // namespace ext
