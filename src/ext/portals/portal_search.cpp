#include "ext/portals/portal_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "pbrt/core/parallel.h"
#include "pbrt/math/rng.h"

namespace ext {
namespace {

constexpr size_t kMaxPortals = 8;
constexpr size_t kMaxRays = 2048;  ///< maximum rays of either kind
constexpr double kBlocked = 0.25;  ///< weight of a blocked ray relative to one that leaves
constexpr int kMaxCells = 48, kMinCells = 8, kSteps = 48, kFineSteps = 8;
constexpr size_t kMinRays = 12;          ///< minimum rays per portal
constexpr double kSmallestShare = 0.02;  ///< minimum share of a portal in the rays that left
constexpr Float kMinCosine = 0.05f;      ///< minimum cosine; rays nearly parallel to a plane are skipped

struct Line {
    Point3 p;
    Vector3 d;
    bool left;
    double count;  ///< number of rays it represents
};

/// Candidate plane normals: of most surfaces, and the axes, with both signs.
std::vector<Vector3> Facings(std::span<const Normal3> normals) {
    std::map<std::array<int, 3>, std::pair<size_t, Vector3>> bins;
    for (const Normal3 &n : normals) {
        if (n == Normal3(0)) continue;
        // Opposite normals define the same planes.
        const bool turned =
            n.x < -1e-3f || (std::abs(n.x) <= 1e-3f && (n.y < -1e-3f || (std::abs(n.y) <= 1e-3f && n.z < 0)));
        const Vector3 v = turned ? Vector3(-n) : Vector3(n);
        const auto place = [](Float x) { return int(std::lround(x * 40)); };
        auto &[count, sum] = bins[{place(v.x), place(v.y), place(v.z)}];
        ++count;
        sum += v;
    }
    std::vector<std::pair<size_t, Vector3>> frequent;
    for (const auto &[key, bin] : bins)
        if (bin.first * 50 >= normals.size()) frequent.push_back({bin.first, Normalize(bin.second)});
    std::stable_sort(frequent.begin(), frequent.end(), [](const auto &a, const auto &b) { return a.first > b.first; });
    if (frequent.size() > 6) frequent.resize(6);
    for (const Vector3 &axis : {Vector3(1, 0, 0), Vector3(0, 1, 0), Vector3(0, 0, 1)}) frequent.push_back({0, axis});
    std::vector<Vector3> facings;
    for (const auto &[count, v] : frequent)
        if (std::none_of(facings.begin(), facings.end(), [&](const Vector3 &f) { return AbsDot(f, v) > 0.999f; }))
            facings.push_back(v);
    const size_t half = facings.size();
    for (size_t i = 0; i < half; ++i) facings.push_back(-facings[i]);
    return facings;
}

/// Frame of the planes: x along another candidate normal if orthogonal.
Frame FrameOf(const Vector3 &z, std::span<const Vector3> facings) {
    for (const Vector3 &x : facings)
        if (AbsDot(x, z) < 0.02f) return Frame::FromXZ(x, z);
    return Frame::FromZ(z);
}

/// Range from the 1st to the 99th percentile.
std::pair<Float, Float> Range(std::vector<Float> v) {
    const size_t skipped = v.size() / 100;
    std::nth_element(v.begin(), v.begin() + skipped, v.end());
    const Float low = v[skipped];
    std::nth_element(v.begin(), v.end() - 1 - skipped, v.end());
    return {low, v[v.size() - 1 - skipped]};
}

/// Slightly widened range of nearly all values.
std::pair<Float, Float> Around(std::vector<Float> v) {
    const auto n = Float(v.size());
    const auto [low, high] = Range(std::move(v));
    const Float more = (high - low) * (1 / n + Float(0.01));
    return {low - more, high + more};
}

/// A line in coordinates of parallel planes.
struct Crossing {
    Vector3 p;  ///< in the planes' frame
    Vector2 slope;
    bool left;
    double count;
    /// Crossing point with a plane; empty if the line starts beyond it.
    std::optional<Point2> At(Float height) const {
        if (!(height > p.z)) return {};
        return Point2(p.x + slope.x * (height - p.z), p.y + slope.y * (height - p.z));
    }
};

/// Empty for lines nearly parallel to the planes.
std::optional<Crossing> CrossingOf(const Frame &frame, const Line &line) {
    const Vector3 d = frame.ToLocal(line.d);
    if (!(d.z > kMinCosine)) return {};
    return Crossing{frame.ToLocal(line.p), Vector2(d.x, d.y) / d.z, line.left, line.count};
}

/// From the cells `open` of an n x n grid, visits cells at most `reach` columns and rows away, and on from those for
/// which take(cell) returns true.
void Flood(int n, int reach, std::vector<size_t> open, auto &&take) {
    while (!open.empty()) {
        const int at = int(open.back()), row = at / n, column = at % n;
        open.pop_back();
        for (int y = std::max(row - reach, 0); y <= std::min(row + reach, n - 1); ++y)
            for (int x = std::max(column - reach, 0); x <= std::min(column + reach, n - 1); ++x)
                if (const size_t to = y * n + x; take(to)) open.push_back(to);
    }
}

/// Lines relative to a family of parallel planes.
class Planes {
  public:
    Planes(const Frame &frame, std::span<const Line> lines) : frame_(frame) {
        // Cell size: cells of a portal must be connected by the rays through them.
        const auto left = double(std::ranges::count_if(lines, [](const Line &line) { return line.left; }));
        cells_ = std::clamp(int(1.5 * std::sqrt(left)), kMinCells, kMaxCells);
        std::vector<Float> x, y, z;
        for (const Line &line : lines) {
            const Vector3 p = frame.ToLocal(line.p);
            x.push_back(p.x), y.push_back(p.y), z.push_back(p.z);
            if (const std::optional<Crossing> c = CrossingOf(frame, line)) crossing_.push_back(*c);
        }
        std::tie(low_.x, high_.x) = Range(std::move(x));
        std::tie(low_.y, high_.y) = Range(std::move(y));
        std::tie(low_.z, high_.z) = Range(std::move(z));
        // Portals lie at the border of the ray origins.
        const Vector3 margin = (high_ - low_) * Float(0.1);
        low_ -= margin, high_ += margin;
    }

    struct Cell {
        std::array<double, 2> left{}, blocked{};  ///< of both halves of the rays
        double Gain(size_t half) const { return left[half] - kBlocked * blocked[half]; }
        double Gain() const { return Gain(0) + Gain(1); }
    };
    using Grid = std::vector<Cell>;
    struct Plane {
        double gain = 0;
        Float height = 0;
    };

    /// The plane of maximum gain; `heldOut`: see FindPortals.
    Plane Best(bool heldOut) const {
        Plane best;
        const auto test = [&](Float height) {
            const double gain = GainAt(height, heldOut);
            if (gain > best.gain) best = {gain, height};
        };
        const Float step = (high_.z - low_.z) / kSteps;
        for (int i = 0; i < kSteps; ++i) test(low_.z + (Float(i) + Float(0.5)) * step);
        const Float coarse = best.height;
        for (int i = -kFineSteps; i <= kFineSteps; ++i) test(coarse + Float(i) * step / kFineSteps);
        return best;
    }

    /// Bounding rectangles of connected cells with positive gain that at least `minCount` rays pass.
    std::vector<Portal> Portals(Float height, double minCount) const {
        const Grid grid = Count(height);
        std::vector<int> component(grid.size(), -1);
        int components = 0;
        for (size_t i = 0; i < grid.size(); ++i) {
            const auto take = [&](size_t cell) {
                if (component[cell] >= 0 || !(grid[cell].Gain() > 0)) return false;
                component[cell] = components;
                return true;
            };
            if (!take(i)) continue;
            Flood(cells_, 1, {i}, take);
            ++components;
        }
        struct Rays {
            std::vector<Float> x, y;
            double count = 0;
        };
        std::vector<Rays> raysOf(components);
        for (const Crossing &c : crossing_) {
            const std::optional<Point2> at = c.At(height);
            const std::optional<size_t> cell = at && c.left ? CellAt(*at) : std::nullopt;
            if (!cell || component[*cell] < 0) continue;
            Rays &rays = raysOf[size_t(component[*cell])];
            rays.x.push_back(at->x), rays.y.push_back(at->y);
            rays.count += c.count;
        }
        std::vector<Portal> portals;
        for (Rays &rays : raysOf) {
            if (rays.x.size() < kMinRays || rays.count < minCount) continue;
            const auto [x0, x1] = Around(std::move(rays.x));
            const auto [y0, y1] = Around(std::move(rays.y));
            portals.push_back({frame_, {x0, y0, height}, {x1, y1, height}});
        }
        return portals;
    }

  private:
    std::optional<size_t> CellAt(const Point2 &at) const {
        const auto n = Float(cells_);
        const Float x = (at.x - low_.x) / (high_.x - low_.x) * n, y = (at.y - low_.y) / (high_.y - low_.y) * n;
        if (!(x >= 0 && y >= 0 && x < n && y < n)) return {};
        return size_t(y) * size_t(cells_) + size_t(x);
    }
    Grid Count(Float height) const {
        Grid grid(size_t(cells_) * cells_);
        for (size_t i = 0; i < crossing_.size(); ++i)
            if (const std::optional<Point2> at = crossing_[i].At(height))
                if (const std::optional<size_t> cell = CellAt(*at))
                    (crossing_[i].left ? grid[*cell].left : grid[*cell].blocked)[i % 2] += crossing_[i].count;
        return grid;
    }
    double GainAt(Float height, bool heldOut) const {
        double gain = 0;
        for (const Cell &cell : Count(height)) {
            if (!heldOut) gain += std::max(cell.Gain(), 0.0);
            for (size_t half = 0; heldOut && half < 2; ++half)
                if (cell.Gain(half) > 0) gain += cell.Gain(1 - half);
        }
        return gain;
    }

    Frame frame_;
    int cells_ = 0;  ///< per side of the grid
    std::vector<Crossing> crossing_;
    Vector3 low_{0}, high_{0};
};

/// Moves a portal to the height at which its leaving rays pass the smallest rectangle: in the opening itself.
Portal AtNarrowest(const Portal &portal, std::span<const Line> lines) {
    std::vector<Crossing> rays;
    for (const Line &line : lines) {
        if (!line.left || !portal.IsPassed(line.p, line.d)) continue;
        if (const std::optional<Crossing> c = CrossingOf(portal.frame, line)) rays.push_back(*c);
    }
    if (rays.size() < kMinRays) return portal;
    const auto at = [&](Float height) -> std::optional<Portal> {
        std::vector<Float> x, y;
        for (const Crossing &ray : rays)
            if (const std::optional<Point2> place = ray.At(height)) x.push_back(place->x), y.push_back(place->y);
        // Rays that start beyond the plane do not pass it; at most 2 % may.
        if (x.size() * 50 < rays.size() * 49) return {};
        const auto [x0, x1] = Around(std::move(x));
        const auto [y0, y1] = Around(std::move(y));
        return Portal{portal.frame, {x0, y0, height}, {x1, y1, height}};
    };
    Portal narrowest = portal;
    const auto area = [](const Portal &w) { return (w.high.x - w.low.x) * (w.high.y - w.low.y); };
    Float least = Infinity;
    const Vector3 size = portal.high - portal.low;
    const Float reach = std::max(size.x, size.y) / 2;
    constexpr int kTried = 24;
    for (int i = -kTried; i <= kTried; ++i) {
        const std::optional<Portal> there = at(portal.low.z + reach * Float(i) / kTried);
        if (there && area(*there) < least) least = area(*there), narrowest = *there;
    }
    return narrowest;
}

constexpr int kRefiningRays = 8192, kRefiningCells = 48;

/// Portal with refined borders; unchanged if no ray passes it.
Portal Refined(const Scene &scene, const Portal &portal, std::span<const PrepassVertex> vertices, uint64_t seed) {
    const Frame &frame = portal.frame;
    const Vector2 size = Vector2(portal.high) - Vector2(portal.low);
    const Vector2 more = size * Float(0.3) + Vector2(Float(0.1) * std::max(size.x, size.y));
    const Point2 low = Point2(portal.low) - more, high = Point2(portal.high) + more;
    const Float diameter = 2 * Length(scene.Bounds().Diagonal());

    std::vector<Point2> passed(kRefiningRays);
    std::vector<char> left(kRefiningRays, 0);
    ParallelForEach(kRefiningRays, 256, [&](int64_t i) {
        Rng rng(Hash(seed, i));
        const auto v = size_t(rng.Uniform() * Float(vertices.size()));
        const PrepassVertex &vertex = vertices[std::min(v, vertices.size() - 1)];
        const Point2 at = low + rng.Uniform2() * (high - low);
        const Vector3 to = frame.FromLocal({at.x, at.y, portal.low.z}) - vertex.at.p;
        if (!(Dot(to, frame.z) > 0)) return;
        if (vertex.at.ns != Normal3(0) && !vertex.transmits &&
            !(Dot(to, vertex.at.ns) * Dot(vertex.wo, vertex.at.ns) > 0))
            return;
        const Vector3 wi = Normalize(to);
        passed[i] = at;
        left[i] = !scene.Occluded(vertex.at, {.L = {}, .wi = wi, .pLight = vertex.at.p + wi * diameter});
    });

    // Cells connected with the portal that rays pass.
    constexpr auto n = kRefiningCells;
    const auto cellOf = [&](const Point2 &at) {
        const Point2 f = (at - low) / (high - low) * Float(n);
        return size_t(std::clamp(int(f.y), 0, n - 1) * n + std::clamp(int(f.x), 0, n - 1));
    };
    std::vector<char> isLit(n * n, 0), isConnected(isLit.size(), 0);
    std::vector<size_t> open;
    const auto take = [&](size_t cell) { return isLit[cell] && !std::exchange(isConnected[cell], true); };
    for (size_t i = 0; i < left.size(); ++i) {
        if (!left[i]) continue;
        const size_t cell = cellOf(passed[i]);
        isLit[cell] = 1;
        const bool isInside = passed[i].x >= portal.low.x && passed[i].y >= portal.low.y &&
                              passed[i].x <= portal.high.x && passed[i].y <= portal.high.y;
        if (isInside && take(cell)) open.push_back(cell);
    }
    // A frame between two panes may be one or two cells wide.
    Flood(n, 2, std::move(open), take);
    Portal found{frame, {high, portal.low.z}, {low, portal.low.z}};
    for (size_t i = 0; i < left.size(); ++i) {
        if (!left[i] || !isConnected[cellOf(passed[i])]) continue;
        found.low = glm::min(found.low, Point3(passed[i], found.low.z));
        found.high = glm::max(found.high, Point3(passed[i], found.low.z));
    }
    if (!(found.low.x < found.high.x && found.low.y < found.high.y)) return portal;
    const Vector3 margin = (found.high - found.low) * Float(0.01);
    found.low -= margin, found.high += margin;
    return found;
}

/// True if nearly all of a portal lies within another in the same plane.
bool LiesIn(const Portal &portal, const Portal &other) {
    if (portal.frame.x != other.frame.x || portal.frame.z != other.frame.z) return false;
    const Vector2 size = portal.high - portal.low,
                  common = glm::min(portal.high, other.high) - glm::max(portal.low, other.low);
    const Float away = std::abs(portal.low.z - other.low.z);
    return away < Float(0.1) * std::max(size.x, size.y) && common.x > 0 && common.y > 0 &&
           common.x * common.y > Float(0.7) * size.x * size.y;
}

/// Portals in the planes of maximum gain, one plane after the other, each of the lines that pass no portal before.
std::vector<Portal> Search(std::vector<Line> lines, std::span<const Vector3> facings, bool heldOut) {
    double left = 0;
    for (const Line &line : lines) left += line.left ? line.count : 0;
    std::vector<Portal> portals;
    while (portals.size() < kMaxPortals && !lines.empty()) {
        std::vector<Planes::Plane> best(facings.size());
        ParallelForEach(int64_t(facings.size()),
                        [&](int64_t i) { best[i] = Planes(FrameOf(facings[i], facings), lines).Best(heldOut); });
        const auto most = std::ranges::max_element(best, {}, &Planes::Plane::gain);
        if (!(most->gain > kSmallestShare * left)) break;
        const Planes planes(FrameOf(facings[size_t(most - best.begin())], facings), lines);
        std::vector<Portal> found = planes.Portals(most->height, kSmallestShare * left);
        if (found.empty()) break;
        if (portals.size() + found.size() > kMaxPortals) found.resize(kMaxPortals - portals.size());
        for (Portal &portal : found) portal = AtNarrowest(portal, lines);
        std::erase_if(lines, [&](const Line &line) {
            return std::ranges::any_of(found, [&](const Portal &p) { return p.IsPassed(line.p, line.d); });
        });
        portals.insert(portals.end(), found.begin(), found.end());
    }
    return portals;
}

/// Root of the second moment of the lines that left, if each is drawn with the best probability of its region, of those
/// of the portals and the remainder: the sum over regions of the root of (all lines in it times those that left).
double RootSecondMoment(std::span<const Portal> portals, std::span<const Line> lines) {
    std::vector<double> all(portals.size() + 1, 0), left(all);
    for (const Line &line : lines) {
        const auto first = std::ranges::find_if(portals, [&](const Portal &p) { return p.IsPassed(line.p, line.d); });
        const auto region = size_t(first - portals.begin());
        all[region] += line.count;
        left[region] += line.left ? line.count : 0;
    }
    double sum = 0;
    for (size_t k = 0; k < all.size(); ++k) sum += std::sqrt(all[k] * left[k]);
    return sum;
}

}  // namespace

std::vector<Portal> FindPortals(std::span<const EnvironmentRay> rays, std::span<const Normal3> normals) {
    std::vector<Line> lines;  // at most kMaxRays of each kind
    size_t count[2] = {0, 0}, seen[2] = {0, 0};
    for (const EnvironmentRay &ray : rays) ++count[ray.left];
    for (const EnvironmentRay &ray : rays) {
        const size_t n = count[ray.left], taken = std::min(n, kMaxRays), i = seen[ray.left]++;
        if (i * taken / n != (i + 1) * taken / n) lines.push_back({ray.p, ray.d, ray.left, double(n) / double(taken)});
    }
    const std::vector<Vector3> facings = Facings(normals);
    std::vector<Portal> portals;
    double least = RootSecondMoment(portals, lines);
    for (const bool heldOut : {false, true}) {
        std::vector<Portal> found = Search(lines, facings, heldOut);
        const double moment = RootSecondMoment(found, lines);
        if (moment < least) least = moment, portals = std::move(found);
    }
    return portals;
}

std::vector<Portal> RefinePortals(const Scene &scene, std::span<const Portal> portals,
                                  std::span<const PrepassVertex> vertices, int seed) {
    std::vector<Portal> refined;
    for (size_t k = 0; k < portals.size(); ++k) {
        const Portal portal = Refined(scene, portals[k], vertices, Hash(uint64_t{0x726566696e65}, seed, uint64_t{k}));
        if (std::any_of(refined.begin(), refined.end(), [&](const Portal &w) { return LiesIn(portal, w); })) continue;
        std::erase_if(refined, [&](const Portal &w) { return LiesIn(w, portal); });
        refined.push_back(portal);
    }
    return refined;
}

}  // namespace ext
