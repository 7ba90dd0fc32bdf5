#include "pbrt/integrators/path_guide.h"

#include <nlohmann/json.hpp>
#include <numeric>

#include "pbrt/core/parallel.h"
#include "pbrt/core/ranks.h"
#include "pbrt/core/state_io.h"
#include "pbrt/math/bounds.h"
#include "pbrt/scene/scene.h"

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
constexpr size_t kCellRecords = 256;
/// No record has a larger part than this of the second moment that directions are learned from and judged by.
constexpr double kLargestPart = 0.05;
/// A cell guides if that brings the second moment of the bounces' contributions below this part.
constexpr double kMinGain = 0.7;
/// What a guided bounce costs besides, in vertices; a cell guides if it saves more than that of the variance.
constexpr double kGuidedCost = 0.3;
/// A share is found from at least so many records.
constexpr size_t kMinJudges = 32;
constexpr int kShares = 7;  ///< that are tried besides 0

/// The path's weight for which PathGuide::Inspect tells the probability to go on.
constexpr Float kInspectedWeight = 0.5f;

/// Changes with everything that PathGuide::Save writes.
constexpr uint32_t kVersion = 4;

}  // namespace

/// Builds what a PathGuide knows from records.
class GuideBuilder {
  public:
    /// `worthOf(i)`: PathRoulette::Worth of the pixel of place i, or 0 if that is not known.
    template <class WorthOf>
    GuideBuilder(std::span<const GuideRecord> places, Float largestShare, WorthOf &&worthOf, PathGuide::Tree *tree)
        : places_(places), largestShare_(largestShare), tree_(*tree) {
        for (size_t i = 0; i < places.size(); ++i)
            if (places[i].added > 0) records_.push_back({&places[i], 0, static_cast<double>(worthOf(i))});
    }

    void Build() {
        tree_ = {};
        if (records_.empty()) return;
        ParallelForEach(3, [&](int64_t part) {
            GuideTargets &targets = part < 2 ? ofHalf_[part] : tree_.targets;
            targets = TargetsOf(part);
        });
        tree_.nodes.emplace_back();
        Divide(0, 0, records_.size());
        tree_.leaves.resize(tasks_.size());
        for (const GuideRecord &place : places_) tasks_[tree_.LeafOf(place.p)].bounces += place.pdf > 0;
        ParallelForEach(static_cast<int64_t>(tasks_.size()), [&](int64_t i) {
            const auto k = static_cast<size_t>(i);
            LeafFor(tasks_[k], &tree_.leaves[k]);
        });
        Collapse(0);
        if (tree_.nodes[0].axis == 3 && !Guides(tree_.leaves[tree_.nodes[0].below])) tree_ = {};
    }

  private:
    struct Entry {
        const GuideRecord *record;
        double counts = 0;  ///< how much its square: the mean radiance where it went over its own
        double worth = 0;
    };
    struct Task {
        size_t begin, end;
        size_t bounces = 0;  ///< those that found nothing included
    };

    static bool Guides(const PathGuide::Leaf &leaf) { return leaf.share[0] > 0 || leaf.share[1] > 0; }

    /// Of the records of one half, or (2) of all.
    GuideTargets TargetsOf(int64_t part) {
        std::vector<TargetFind> finds;
        double sum = 0;
        uint32_t number = 0;
        for (const GuideRecord &r : places_) {
            const uint32_t at = number;
            number += r.added > 0;
            if (!(r.pdf > 0) || (part < 2 && r.isOfFirstHalf != (part == 0))) continue;
            const double radiance = r.added > 0 ? static_cast<double>(r.radiance) : 0;
            finds.push_back({r.p, r.target, radiance, 1 / static_cast<double>(r.pdf), 0, at});
            sum += radiance / static_cast<double>(r.pdf);
        }
        for (TargetFind &f : finds) f.radiance = std::min(f.radiance, kLargestPart * sum / f.perPdf);
        const GuideTargets targets = MakeGuideTargets(finds);
        if (part == 2)
            for (const TargetFind &f : finds)
                if (f.radiance > 0) records_[f.number].counts = std::min(1.0, f.meanRadiance / f.radiance);
        return targets;
    }

    void Divide(size_t node, size_t begin, size_t end) {
        const auto makeLeaf = [&] {
            tree_.nodes[node].below = static_cast<uint32_t>(tasks_.size());
            tasks_.push_back({begin, end, 0});
        };
        if (end - begin <= kCellRecords) return makeLeaf();
        Bounds3 bounds;
        for (size_t i = begin; i < end; ++i) bounds = Union(bounds, records_[i].record->p);
        const Vector3 size = bounds.high - bounds.low;
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        const size_t middle = begin + (end - begin) / 2;
        const auto at = [&](size_t i) { return records_.begin() + static_cast<std::ptrdiff_t>(i); };
        std::nth_element(at(begin), at(middle), at(end),
                         [&](const Entry &a, const Entry &b) { return a.record->p[axis] < b.record->p[axis]; });
        const Float split = records_[middle].record->p[axis];
        const size_t first = static_cast<size_t>(
            std::partition(at(begin), at(end), [&](const Entry &e) { return e.record->p[axis] < split; }) -
            records_.begin());
        if (first == begin) return makeLeaf();  // all lie in a plane across the axis, or in one point
        const auto below = static_cast<uint32_t>(tree_.nodes.size());
        tree_.nodes[node] = {split, static_cast<uint32_t>(axis), below};
        tree_.nodes.resize(tree_.nodes.size() + 2);
        Divide(below, begin, first);
        Divide(below + 1, first, end);
    }

    /// Finds the shares of a leaf.
    void LeafFor(const Task &task, PathGuide::Leaf *leaf) const {
        struct Judged {
            double square, bsdfPdf, guidePdf;
            double worth;  ///< of what the BSDF alone would have added, squared
        };
        std::vector<Judged> judged[2];
        bool knowsWorth = true;
        for (size_t i = task.begin; i < task.end; ++i) {
            const GuideRecord &r = *records_[i].record;
            if (!(r.bsdfPdf > 0 && r.added > 0)) continue;
            GuideDirections directions;
            directions.Prepare(ofHalf_[r.isOfFirstHalf ? 1 : 0], r.p, r.normal, r.bothSides);
            const auto added = static_cast<double>(r.added), pdf = static_cast<double>(r.pdf),
                       bsdfPdf = static_cast<double>(r.bsdfPdf);
            judged[r.isGlossy ? 1 : 0].push_back(
                {added * added * records_[i].counts * pdf, bsdfPdf, static_cast<double>(directions.Pdf(r.wi)),
                 added * added * pdf / bsdfPdf * records_[i].worth * records_[i].worth});
            knowsWorth &= records_[i].worth > 0;
        }
        double gained = 0;
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
            double best = plain;
            if (judged[kind].size() >= kMinJudges)
                for (int i = 1; i <= kShares; ++i) {
                    const Float share = largestShare_ * static_cast<Float>(i) / kShares;
                    const double moment = momentAt(static_cast<double>(share));
                    if (moment > kMinGain * plain || moment > best) continue;
                    best = moment;
                    leaf->share[kind] = share;
                }
            double all = 0, worth = 0;
            for (const Judged &j : judged[kind]) all += j.worth;
            for (const Judged &j : judged[kind]) worth += std::min(j.worth, kLargestPart * all);
            if (leaf->share[kind] > 0) gained += worth * (1 - best / plain);
        }
        if (knowsWorth && gained < kGuidedCost * static_cast<double>(task.bounces)) *leaf = {};
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

    std::span<const GuideRecord> places_;
    std::vector<Entry> records_;  ///< of what found something
    const Float largestShare_;
    PathGuide::Tree &tree_;
    std::vector<Task> tasks_;
    GuideTargets ofHalf_[2];
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
    const Bounds3 &bounds = prepare.scene.Bounds();
    beyond_ = bounds.IsEmpty() ? 1 : 10 * Length(bounds.high - bounds.low);
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
    in.Value(&tree_.targets);
    for (size_t i = 0; i < tree_.nodes.size(); ++i) {
        const Node &node = tree_.nodes[i];
        const bool isLeaf = node.axis == 3;
        if (node.axis > 3 ||
            (isLeaf ? node.below >= tree_.leaves.size() : node.below <= i || node.below + 1 >= tree_.nodes.size()))
            in.Refuse();
    }
    for (const Leaf &leaf : tree_.leaves)
        for (const Float share : leaf.share)
            if (share != 0 && !(share > 0 && share < 1)) in.Refuse();
    if (tree_.targets.count < 0 || tree_.targets.count > GuideTargets::kMost) in.Refuse();
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
    out.Value(tree_.targets);
    roulette_.Save(out);
    TakeRecords(out);
}

const GuideTargets *PathGuide::At(const Point3 &p, bool isGlossy, Float *share) const {
    if (tree_.nodes.empty()) return nullptr;
    const Leaf &leaf = tree_.leaves[tree_.LeafOf(p)];
    *share = leaf.share[isGlossy ? 1 : 0];
    return *share > 0 ? &tree_.targets : nullptr;
}

void PathGuide::Inspect(const PathVertex &vertex, Point2i pixel, std::vector<InspectedValue> &values) const {
    const double unknown = std::numeric_limits<double>::quiet_NaN();
    const Point3 &p = vertex.point.p;
    const Float survival =
        roulette_.Knows() ? roulette_.SurvivalAt(p, PathRoulette::KindOf(vertex), kInspectedWeight, InPicture(pixel))
                          : 0;
    values.push_back({"survival", survival > 0 ? static_cast<double>(survival) : unknown});
    if (!params_.directions) return;
    Float share = 0, radiance = 0;
    if (Guides(vertex.bsdf)) At(p, Has(vertex.bsdf.Flags(), BxdfFlags::Glossy), &share);
    for (size_t k = 0; k < static_cast<size_t>(tree_.targets.count); ++k)
        if (LengthSquared(Point3(tree_.targets.x[k], tree_.targets.y[k], tree_.targets.z[k]) - p) <=
            tree_.targets.r2[k])
            radiance = std::max(radiance, tree_.targets.radiance[k]);
    values.push_back({"share", static_cast<double>(share)});
    values.push_back({"shines", radiance > 0 ? std::log10(static_cast<double>(radiance)) : unknown});
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
    if (params_.roulette) roulette_.Learn(pixels_.high - pixels_.low, [&](size_t path) { return PixelOf(path); });
    const auto worthOf = [&](size_t place) {
        return roulette_.Knows() ? roulette_.Worth(PixelOf(place / vertices_)) : Float(0);
    };
    GuideBuilder(places_, params_.share, worthOf, &tree_).Build();
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
    json["targets"] = tree_.targets.count;
    json["meanShare"] = tree_.leaves.empty() ? 0 : shares / static_cast<double>(tree_.leaves.size());
}

}  // namespace pbrt
