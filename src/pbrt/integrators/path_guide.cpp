#include "pbrt/integrators/path_guide.h"

#include <nlohmann/json.hpp>
#include <numeric>

#include "pbrt/core/parallel.h"
#include "pbrt/core/ranks.h"
#include "pbrt/core/state_io.h"
#include "pbrt/math/bounds.h"

namespace pbrt {

namespace {

/// Numbers of samples per pixel after which the guide learns, from the samples since it learned last. It does so if at
/// least as many samples are still to come.
constexpr int kLearnAfter[] = {2, 8, 32};
/// Only so many vertices of a path are recorded.
constexpr int kMaxVertices = 5;
/// Each row of pixels is shifted by this much against the row before, so that the recorded pixels do not form columns.
constexpr int kRowShift = 7;

/// A cell with more records is divided.
constexpr size_t kCellRecords = 128;
/// What a cell's records say of directions counts against what the cell above said like their number against one of
/// these: the one that is best for the records that it was not learned from.
constexpr double kPriorRecords[] = {8, 64, 512};
constexpr size_t kPriors = std::size(kPriorRecords);
/// No record has a larger part than this of what its cell learns, or of the second moment that judges it.
constexpr double kLargestPart = 0.05;
/// This part of a grid is the same for all directions.
constexpr Float kEven = 0.1f;
/// A cell guides if that brings the second moment of the bounces' contributions below this part.
constexpr double kMinGain = 0.7;
/// A share is found from at least so many records.
constexpr size_t kMinJudges = 32;
constexpr int kShares = 7;  ///< that are tried besides 0

/// For every cell of a grid itself and its eight neighbours, over the borders of the square.
struct Neighbours {
    std::array<std::array<uint8_t, 9>, GuideGrid::kCells> of;
    Neighbours() {
        constexpr int kSide = GuideGrid::kSide;
        for (int cell = 0; cell < GuideGrid::kCells; ++cell)
            for (int k = 0; k < 9; ++k) {
                const Point2 at((static_cast<Float>(cell % kSide + k % 3 - 1) + 0.5f) / kSide,
                                (static_cast<Float>(cell / kSide + k / 3 - 1) + 0.5f) / kSide);
                const Point2 inside = WrapEqualAreaSquare(at) * Float(kSide);
                of[static_cast<size_t>(cell)][static_cast<size_t>(k)] =
                    static_cast<uint8_t>(std::clamp(static_cast<int>(inside.y), 0, kSide - 1) * kSide +
                                         std::clamp(static_cast<int>(inside.x), 0, kSide - 1));
            }
    }
};
/// A record counts in its own cell of the grid and in the neighbours.
constexpr double kSpread[9] = {1 / 16., 1 / 8., 1 / 16., 1 / 8., 1 / 4., 1 / 8., 1 / 16., 1 / 8., 1 / 16.};

/// Changes with everything that PathGuide::Save writes.
constexpr uint32_t kVersion = 2;

}  // namespace

/// Builds what a PathGuide knows from records.
class GuideBuilder {
  public:
    GuideBuilder(std::vector<const GuideRecord *> records, Float largestShare, PathGuide::Tree *tree)
        : records_(std::move(records)), largestShare_(largestShare), tree_(*tree) {}

    void Build() {
        tree_ = {};
        if (records_.empty()) return;
        tree_.nodes.emplace_back();
        Histogram even;
        even.fill(1.0 / GuideGrid::kCells);
        Histograms start;
        start.fill({even, even, even});
        Divide(0, 0, records_.size(), start);
        Judge();
        Collapse(0);
        if (tree_.nodes[0].axis == 3 && !Guides(tree_.leaves[0])) tree_ = {};
    }

  private:
    using Histogram = std::array<double, GuideGrid::kCells>;
    /// Shares of the cells of a grid in the second moment of radiance, by the records of each half and by all; for each
    /// of kPriorRecords.
    using Histograms = std::array<std::array<Histogram, 3>, kPriors>;
    struct Task {
        size_t begin, end;
        Histograms shares;
    };

    static bool Guides(const PathGuide::Leaf &leaf) { return leaf.share[0] > 0 || leaf.share[1] > 0; }

    Histograms Count(size_t begin, size_t end, const Histograms &prior) const {
        const auto value = [](const GuideRecord &r) {
            return static_cast<double>(r.radiance) * static_cast<double>(r.radiance) / static_cast<double>(r.pdf);
        };
        const static Neighbours kNeighbours;
        std::array<Histogram, 3> sums{};
        double total[3] = {}, count[3] = {};
        const auto forAll = [&](auto &&visit) {
            for (size_t i = begin; i < end; ++i) {
                visit(*records_[i], records_[i]->isOfFirstHalf ? 0 : 1);
                visit(*records_[i], 2);
            }
        };
        forAll([&](const GuideRecord &r, size_t part) { total[part] += value(r); });
        double kept[3] = {};
        forAll([&](const GuideRecord &r, size_t part) {
            const double v = std::min(value(r), kLargestPart * total[part]);
            const auto &near = kNeighbours.of[static_cast<size_t>(GuideGrid::CellOf(r.wi))];
            for (size_t k = 0; k < 9; ++k) sums[part][near[k]] += kSpread[k] * v;
            kept[part] += v;
            ++count[part];
        });
        Histograms shares;
        for (size_t k = 0; k < kPriors; ++k)
            for (size_t part = 0; part < 3; ++part)
                for (size_t cell = 0; cell < GuideGrid::kCells; ++cell) {
                    const double known = kept[part] > 0 ? count[part] : 0;
                    const double own = known > 0 ? sums[part][cell] / kept[part] * known : 0;
                    shares[k][part][cell] =
                        (own + kPriorRecords[k] * prior[k][part][cell]) / (known + kPriorRecords[k]);
                }
        return shares;
    }

    void Divide(size_t node, size_t begin, size_t end, const Histograms &prior) {
        const Histograms shares = Count(begin, end, prior);
        const auto makeLeaf = [&] {
            tree_.nodes[node].below = static_cast<uint32_t>(tasks_.size());
            tasks_.push_back({begin, end, shares});
        };
        if (end - begin <= kCellRecords) return makeLeaf();
        Bounds3 bounds;
        for (size_t i = begin; i < end; ++i) bounds = Union(bounds, records_[i]->p);
        const Vector3 size = bounds.high - bounds.low;
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        const size_t middle = begin + (end - begin) / 2;
        const auto at = [&](size_t i) { return records_.begin() + static_cast<std::ptrdiff_t>(i); };
        std::nth_element(at(begin), at(middle), at(end),
                         [&](const GuideRecord *a, const GuideRecord *b) { return a->p[axis] < b->p[axis]; });
        const Float split = records_[middle]->p[axis];
        const size_t first = static_cast<size_t>(
            std::partition(at(begin), at(end), [&](const GuideRecord *r) { return r->p[axis] < split; }) -
            records_.begin());
        if (first == begin) return makeLeaf();  // all lie in a plane across the axis, or in one point
        const auto below = static_cast<uint32_t>(tree_.nodes.size());
        tree_.nodes[node] = {split, static_cast<uint32_t>(axis), below};
        tree_.nodes.resize(tree_.nodes.size() + 2);
        Divide(below, begin, first, shares);
        Divide(below + 1, first, end, shares);
    }

    /// The grid that makes the second moment least: the square root of what arrives.
    static GuideGrid GridOf(const Histogram &shares) {
        GuideGrid grid;
        double sum = 0;
        for (const double share : shares) sum += std::sqrt(share);
        for (size_t i = 0; i < GuideGrid::kCells; ++i)
            grid.cell[i] = static_cast<Float>(std::sqrt(shares[i]) / sum) * (1 - kEven) + kEven / GuideGrid::kCells;
        return grid;
    }

    void Judge() {
        tree_.leaves.resize(tasks_.size());
        std::vector<GuideGrid> grids(tasks_.size());
        ParallelForEach(static_cast<int64_t>(tasks_.size()), [&](int64_t i) {
            const auto k = static_cast<size_t>(i);
            size_t prior = 0;
            tree_.leaves[k] = LeafOf(tasks_[k], &prior);
            grids[k] = GridOf(tasks_[k].shares[prior][2]);
        });
        for (size_t k = 0; k < tasks_.size(); ++k) {
            if (!Guides(tree_.leaves[k])) continue;
            tree_.leaves[k].grid = static_cast<uint32_t>(tree_.grids.size());
            tree_.grids.push_back(grids[k]);
        }
    }

    /// The shares of a leaf, and for which of kPriorRecords its grid is made.
    PathGuide::Leaf LeafOf(const Task &task, size_t *prior) const {
        PathGuide::Leaf best;
        double bestRatio = kMinGain;
        for (size_t k = 0; k < kPriors; ++k) {
            PathGuide::Leaf leaf;
            if (const double ratio = LeafFor(task, task.shares[k], &leaf); ratio < bestRatio) {
                bestRatio = ratio;
                best = leaf;
                *prior = k;
            }
        }
        return best;
    }

    /// Returns the second moment over that without a guide.
    double LeafFor(const Task &task, const std::array<Histogram, 3> &shares, PathGuide::Leaf *leaf) const {
        struct Judged {
            double square, bsdfPdf, guidePdf;
        };
        const GuideGrid ofHalf[2] = {GridOf(shares[0]), GridOf(shares[1])};
        std::vector<Judged> judged[2];
        for (size_t i = task.begin; i < task.end; ++i) {
            const GuideRecord &r = *records_[i];
            if (!(r.bsdfPdf > 0)) continue;
            GuideDirections directions;
            directions.Prepare(ofHalf[r.isOfFirstHalf ? 1 : 0], r.normal, r.bothSides);
            const auto added = static_cast<double>(r.added);
            judged[r.isGlossy ? 1 : 0].push_back({added * added * static_cast<double>(r.pdf),
                                                  static_cast<double>(r.bsdfPdf),
                                                  static_cast<double>(directions.Pdf(r.wi))});
        }
        double before = 0, after = 0;
        for (size_t kind = 0; kind < 2; ++kind) {
            double unguided = 0;
            for (const Judged &j : judged[kind]) unguided += j.square / j.bsdfPdf;
            const double most = kLargestPart * unguided;
            const auto momentAt = [&](double share) {
                double sum = 0;
                for (const Judged &j : judged[kind])
                    sum += std::min(j.square, most * j.bsdfPdf) / ((1 - share) * j.bsdfPdf + share * j.guidePdf);
                return sum;
            };
            const double plain = momentAt(0);
            before += plain;
            double best = plain;
            if (judged[kind].size() >= kMinJudges)
                for (int i = 1; i <= kShares; ++i) {
                    const Float share = largestShare_ * static_cast<Float>(i) / kShares;
                    const double moment = momentAt(static_cast<double>(share));
                    if (moment > kMinGain * plain || moment > best) continue;
                    best = moment;
                    leaf->share[kind] = share;
                }
            after += best;
        }
        return before > 0 ? after / before : 1;
    }

    /// Makes leaves of nodes below which nothing guides. True: the node is such a leaf.
    bool Collapse(size_t node) {
        const PathGuide::Node n = tree_.nodes[node];
        if (n.axis == 3) return !Guides(tree_.leaves[n.below]);
        const bool first = Collapse(n.below), second = Collapse(n.below + 1);
        if (!first || !second) return false;
        tree_.nodes[node] = tree_.nodes[n.below];
        return true;
    }

    std::vector<const GuideRecord *> records_;
    const Float largestShare_;
    PathGuide::Tree &tree_;
    std::vector<Task> tasks_;
};

bool PathGuide::Guides(const Bsdf &bsdf) {
    const BxdfFlags flags = bsdf.Flags();
    return IsNonSpecular(flags) && !(IsTransmissive(flags) && Has(flags, BxdfFlags::Glossy)) && bsdf.HasExactF();
}

void PathGuide::Prepare(PrepareContext &prepare, int maxDepth) {
    pixels_ = prepare.pixelBounds;
    samplesPerPixel_ = prepare.samplesPerPixel;
    vertices_ = static_cast<size_t>(std::clamp(maxDepth, 1, kMaxVertices));
    tree_ = {};
    BeginLearning(0, NextAfter(0));
    // A file of learned lights holds nothing for the guide.
    if (!prepare.learned || prepare.learned->BytesLeft() == 0) return;
    StateReader &in = *prepare.learned;
    if (in.Value<uint32_t>() != kVersion) in.Refuse();
    const int first = in.Value<int>(), next = in.Value<int>();
    if (next != 0 &&
        (next <= first || std::find(std::begin(kLearnAfter), std::end(kLearnAfter), next) == std::end(kLearnAfter)))
        in.Refuse();
    in.Vector(&tree_.nodes);
    in.Vector(&tree_.leaves);
    in.Vector(&tree_.grids);
    for (size_t i = 0; i < tree_.nodes.size(); ++i) {
        const Node &node = tree_.nodes[i];
        const bool isLeaf = node.axis == 3;
        if (node.axis > 3 ||
            (isLeaf ? node.below >= tree_.leaves.size() : node.below <= i || node.below + 1 >= tree_.nodes.size()))
            in.Refuse();
    }
    for (const Leaf &leaf : tree_.leaves)
        for (const Float share : leaf.share)
            if (share != 0 && !(share > 0 && share < 1 && leaf.grid < tree_.grids.size())) in.Refuse();
    roulette_.Load(in);
    BeginLearning(first, next);
    AddRecords(in);
}

void PathGuide::Save(StateWriter &out) const {
    out.Value(kVersion);
    out.Value(first_);
    out.Value(next_);
    out.Vector(tree_.nodes);
    out.Vector(tree_.leaves);
    out.Vector(tree_.grids);
    roulette_.Save(out);
    TakeRecords(out);
}

const GuideGrid *PathGuide::At(const Point3 &p, bool isGlossy, Float *share) const {
    if (tree_.nodes.empty()) return nullptr;
    const Node *node = tree_.nodes.data();
    while (node->axis != 3) node = &tree_.nodes[node->below + (p[static_cast<int>(node->axis)] < node->split ? 0 : 1)];
    const Leaf &leaf = tree_.leaves[node->below];
    *share = leaf.share[isGlossy ? 1 : 0];
    return *share > 0 ? &tree_.grids[leaf.grid] : nullptr;
}

int PathGuide::NextAfter(int first) const {
    const auto *next = std::upper_bound(std::begin(kLearnAfter), std::end(kLearnAfter), first);
    return next != std::end(kLearnAfter) && 2 * *next <= samplesPerPixel_ ? *next : 0;
}

void PathGuide::BeginLearning(int first, int next) {
    first_ = first;
    next_ = next;
    places_ = {};
    roulette_.BeginRecords(0, 0);
    if (next_ == 0) return;
    const Vector2i size = pixels_.IsEmpty() ? Vector2i(0) : pixels_.high - pixels_.low;
    for (stride_ = 1;; ++stride_) {
        placesPerRow_ = static_cast<size_t>((size.x + stride_ - 1) / stride_);
        const size_t paths = placesPerRow_ * static_cast<size_t>(size.y) * static_cast<size_t>(next_ - first_);
        if (paths * vertices_ > static_cast<size_t>(params_.records) && stride_ < size.x) continue;
        if (params_.directions) places_.assign(paths * vertices_, {});
        roulette_.BeginRecords(params_.roulette ? paths : 0, vertices_ + 1);
        return;
    }
}

Point2i PathGuide::PixelOf(size_t path) const {
    const size_t ofPixel = path / static_cast<size_t>(next_ - first_);
    const int y = static_cast<int>(ofPixel / placesPerRow_);
    // x + kRowShift y is a multiple of the stride.
    const int shift = (stride_ - kRowShift * y % stride_) % stride_;
    return {static_cast<int>(ofPixel % placesPerRow_) * stride_ + shift, y};
}

std::optional<size_t> PathGuide::PathNumber(Point2i pixel, int sample) const {
    const Vector2i at = pixel - pixels_.low;
    if (next_ == 0 || sample < first_ || sample >= next_ || (at.x + kRowShift * at.y) % stride_ != 0) return {};
    const size_t ofPixel = static_cast<size_t>(at.y) * placesPerRow_ + static_cast<size_t>(at.x / stride_);
    return ofPixel * static_cast<size_t>(next_ - first_) + static_cast<size_t>(sample - first_);
}

int PathGuide::NextLearning() const {
    const int ofLights = lights_ ? lights_->NextLearning() : 0;
    return ofLights == 0 || next_ == 0 ? std::max(ofLights, next_) : std::min(ofLights, next_);
}

void PathGuide::Learn(const Progress &progress) {
    if (progress.Cancelled()) return;
    const int now = NextLearning();
    const bool isDue = next_ == now;
    if (lights_ && lights_->NextLearning() == now) {
        lights_->Learn(progress);
        if (lights_->NextLearning() == now) return;
    }
    if (!isDue || progress.Cancelled()) return;
    std::vector<const GuideRecord *> records;
    for (const GuideRecord &place : places_)
        if (place.pdf > 0) records.push_back(&place);
    GuideBuilder(std::move(records), params_.share, &tree_).Build();
    if (params_.roulette) roulette_.Learn(pixels_.high - pixels_.low, [&](size_t path) { return PixelOf(path); });
    BeginLearning(now, NextAfter(now));
}

void PathGuide::TakeRecords(StateWriter &out) const {
    uint64_t filled = 0;
    for (const GuideRecord &place : places_) filled += place.pdf > 0;
    out.Value(uint64_t{places_.size()});
    out.Value(filled);
    for (size_t i = 0; i < places_.size(); ++i) {
        if (!(places_[i].pdf > 0)) continue;
        out.Value(uint64_t{i});
        out.Value(places_[i]);
    }
    roulette_.TakeRecords(out);
}

void PathGuide::AddRecords(StateReader &in) {
    if (in.Value<uint64_t>() != places_.size()) in.Refuse();
    for (auto filled = in.Value<uint64_t>(); filled > 0; --filled) {
        const auto i = in.Value<uint64_t>();
        if (i >= places_.size()) in.Refuse();
        in.Value(&places_[i]);
    }
    roulette_.AddRecords(in);
}

void PathGuide::TakeFound(StateWriter &out) {
    if (lights_ && lights_->NextLearning() > 0) lights_->TakeFound(out);
    TakeRecords(out);
    std::fill(places_.begin(), places_.end(), GuideRecord{});
    roulette_.ClearRecords();
}

void PathGuide::AddFound(StateReader &in) {
    if (lights_ && lights_->NextLearning() > 0) lights_->AddFound(in);
    AddRecords(in);
}

void PathGuide::Report(nlohmann::ordered_json &json) const {
    size_t guiding = 0;
    double shares = 0;
    for (const Leaf &leaf : tree_.leaves) {
        const Float most = std::max(leaf.share[0], leaf.share[1]);
        guiding += most > 0;
        shares += static_cast<double>(most);
    }
    json["rouletteCells"] = roulette_.Cells();
    json["cells"] = tree_.leaves.size();
    json["guidingCells"] = guiding;
    json["meanShare"] = tree_.leaves.empty() ? 0 : shares / static_cast<double>(tree_.leaves.size());
}

}  // namespace pbrt
