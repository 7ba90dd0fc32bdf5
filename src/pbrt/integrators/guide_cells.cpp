#include "pbrt/integrators/guide_cells.h"

#include <algorithm>
#include <utility>

#include "pbrt/core/parallel.h"

namespace pbrt {

namespace {

/// A cell with more records that found something is divided.
constexpr size_t kCellRecords = 256;
/// No record has a larger part than this of the second moment that directions are learned from and judged by.
constexpr double kLargestPart = 0.05;
/// What the cell above says of a ball counts like so many finds in it.
constexpr double kPriorFinds = 8;
/// Places of a cell that the solid angles of balls are averaged over.
constexpr size_t kCellPlaces = 32;
/// About so many places that bounces left from are given to MakeGuideTargets.
constexpr size_t kFrom = 1024;
/// A cell guides if that brings the second moment of what bounces find below this part.
constexpr double kMinGain = 0.9;
/// A share is found from at least so many records.
constexpr size_t kMinJudges = 32;
constexpr int kShares = 7;  ///< that are tried besides 0

}  // namespace

class GuideCellsBuilder {
  public:
    GuideCellsBuilder(std::span<const GuideRecord> places, Float largestShare, GuideCells *cells)
        : places_(places), largestShare_(largestShare), cells_(*cells) {
        for (const GuideRecord &place : places)
            if (place.found > 0) records_.push_back({.record = &place});
    }

    void Build() {
        cells_.Forget();
        if (records_.empty()) return;
        ParallelForEach(kParts, [&](int64_t part) { FindTargets(static_cast<size_t>(part)); });
        cells_.nodes_.emplace_back();
        Divide(0, 0, records_.size());
        cells_.leaves_.resize(tasks_.size());
        SortBounces();
        ParallelForEach(kParts, [&](int64_t part) { TellCells(static_cast<size_t>(part)); });
        ParallelForEach(static_cast<int64_t>(tasks_.size()), [&](int64_t i) {
            const auto k = static_cast<size_t>(i);
            FindShares(tasks_[k], &cells_.leaves_[k]);
        });
        Collapse(0);
        if (cells_.nodes_[0].axis == 3 && !cells_.leaves_[cells_.nodes_[0].below].Guides()) return cells_.Forget();
        cells_.targets_ = std::move(targets_[kAll]);
        cells_.LeavesChanged();
    }

  private:
    /// The two halves of the records, and all of them.
    static constexpr size_t kAll = 2, kParts = 3;
    struct Entry {
        const GuideRecord *record;
        double counts = 0;  ///< how much its square: the mean radiance where it went over its own
        uint32_t ball[kParts] = {TargetFind::kNone, TargetFind::kNone, TargetFind::kNone};
        double flux[kParts] = {};  ///< radiance times cosine over density, limited
    };
    /// What is to become a leaf.
    struct Task {
        size_t begin, end;                    ///< of records_
        size_t firstBounce = 0, bounces = 0;  ///< in bounces_
        size_t kindBounces[2] = {};           ///< bounces at BSDFs without and with glossy lobes
        GuideTargets targets[kParts] = {};
    };

    static bool IsOf(const GuideRecord &r, size_t part) { return part == kAll || r.isOfFirstHalf == (part == 0); }
    static double CosineOf(const GuideRecord &r) {
        return r.bothSides ? 1 : static_cast<double>(std::abs(Dot(r.wi, r.normal)));
    }

    void FindTargets(size_t part) {
        std::vector<TargetFind> finds;
        std::vector<Point3> from;
        double sum = 0;
        uint32_t number = 0;
        size_t bounces = 0;
        const size_t step = std::max<size_t>(1, places_.size() / kFrom);
        for (size_t i = 0; i < places_.size(); ++i) {
            const GuideRecord &r = places_[i];
            const uint32_t at = number;
            number += r.found > 0;
            if (!(r.pdf > 0) || !IsOf(r, part)) continue;
            if (bounces++ % step == 0) from.push_back(r.p);
            if (!(r.found > 0 && r.radiance > 0)) continue;
            const double perPdf = 1 / static_cast<double>(r.pdf);
            finds.push_back(
                {.target = r.target, .radiance = static_cast<double>(r.radiance), .perPdf = perPdf, .number = at});
            sum += finds.back().radiance * perPdf;
        }
        for (TargetFind &f : finds) f.radiance = std::min(f.radiance, kLargestPart * sum / f.perPdf);
        targets_[part] = MakeGuideTargets(finds, from, bounces);
        // What was found scatters much; where it was found tells what a cell sees.
        std::vector<double> radiances(targets_[part].size()), counts(radiances.size());
        for (const TargetFind &f : finds)
            if (f.ball != TargetFind::kNone) {
                radiances[f.ball] += f.radiance;
                ++counts[f.ball];
            }
        for (const TargetFind &f : finds) {
            if (!(f.radiance > 0)) continue;
            Entry &entry = records_[f.number];
            entry.ball[part] = f.ball;
            if (f.ball != TargetFind::kNone)
                entry.flux[part] = radiances[f.ball] / counts[f.ball] * f.perPdf * CosineOf(*entry.record);
            if (part == kAll) entry.counts = std::min(1.0, f.meanRadiance / f.radiance);
        }
    }

    void Divide(size_t node, size_t begin, size_t end) {
        const auto makeLeaf = [&] {
            cells_.nodes_[node].below = static_cast<uint32_t>(tasks_.size());
            tasks_.push_back({.begin = begin, .end = end});
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
        const auto below = static_cast<uint32_t>(cells_.nodes_.size());
        cells_.nodes_[node] = {split, static_cast<uint32_t>(axis), below};
        cells_.nodes_.resize(cells_.nodes_.size() + 2);
        Divide(below, begin, first);
        Divide(below + 1, first, end);
    }

    /// All bounces of a task, those that found nothing included, become neighbours.
    void SortBounces() {
        std::vector<uint32_t> leaves(places_.size());
        for (size_t i = 0; i < places_.size(); ++i) {
            if (!(places_[i].pdf > 0)) continue;
            leaves[i] = cells_.LeafOf(places_[i].p);
            ++tasks_[leaves[i]].bounces;
            ++tasks_[leaves[i]].kindBounces[places_[i].isGlossy ? 1 : 0];
        }
        size_t sum = 0;
        for (Task &task : tasks_) task.firstBounce = std::exchange(sum, sum + task.bounces);
        bounces_.resize(sum);
        std::vector<size_t> next;
        for (const Task &task : tasks_) next.push_back(task.firstBounce);
        for (size_t i = 0; i < places_.size(); ++i)
            if (places_[i].pdf > 0) bounces_[next[leaves[i]]++] = static_cast<uint32_t>(i);
    }

    /// How bright the balls of a part are for each task: from above to below, what was found over what was expected,
    /// where few finds count less than what the cell above says.
    void TellCells(size_t part) {
        const std::vector<GuideTarget> &targets = targets_[part];
        const size_t count = targets.size(), nodes = cells_.nodes_.size();
        if (count == 0) return;
        std::vector<double> found(nodes * count), expected(nodes * count), factor(nodes * count), perFind(count),
            finds(count), solidAngle(tasks_.size() * count);
        for (size_t node = nodes; node-- > 0;) {
            const GuideCells::Node &n = cells_.nodes_[node];
            double *const f = &found[node * count], *const e = &expected[node * count];
            if (n.axis != 3) {
                const double *const f0 = &found[n.below * count], *const e0 = &expected[n.below * count];
                for (size_t k = 0; k < count; ++k) {
                    f[k] = f0[k] + f0[count + k];
                    e[k] = e0[k] + e0[count + k];
                }
                continue;
            }
            const Task &task = tasks_[n.below];
            for (size_t i = task.begin; i < task.end; ++i) {
                const Entry &entry = records_[i];
                if (entry.ball[part] == TargetFind::kNone) continue;
                f[entry.ball[part]] += entry.flux[part];
                perFind[entry.ball[part]] += entry.flux[part];
                ++finds[entry.ball[part]];
            }
            double *const angle = &solidAngle[n.below * count];
            const size_t step = std::max<size_t>(1, task.bounces / kCellPlaces);
            size_t places = 0;
            for (size_t i = 0; i < task.bounces; i += step, ++places) {
                const GuideRecord &r = places_[bounces_[task.firstBounce + i]];
                for (size_t k = 0; k < count; ++k)
                    angle[k] += static_cast<double>(SolidAngleOf(targets[k], r.p, r.normal, r.bothSides));
            }
            double ofPart = 0;
            for (size_t i = 0; i < task.bounces; ++i) ofPart += IsOf(places_[bounces_[task.firstBounce + i]], part);
            for (size_t k = 0; k < count; ++k) {
                if (places > 0) angle[k] /= static_cast<double>(places);
                e[k] = ofPart * static_cast<double>(targets[k].radiance) * angle[k];
            }
        }
        for (size_t k = 0; k < count; ++k) perFind[k] = finds[k] > 0 ? kPriorFinds * perFind[k] / finds[k] : 0;
        for (size_t node = 0; node < nodes; ++node) {
            const GuideCells::Node &n = cells_.nodes_[node];
            if (node == 0) std::fill_n(factor.begin(), count, 1.0);
            for (size_t k = 0; k < count; ++k) {
                double &a = factor[node * count + k];  // so far that of the node above
                const double f = found[node * count + k] + perFind[k];
                a = f > 0 && a > 0 ? f / (expected[node * count + k] + perFind[k] / a) : 0;
            }
            if (n.axis != 3) {
                for (size_t child = n.below; child < n.below + 2; ++child)
                    std::copy_n(&factor[node * count], count, &factor[child * count]);
                continue;
            }
            tasks_[n.below].targets[part] =
                ChooseTargets(targets, {&factor[node * count], count}, {&solidAngle[n.below * count], count});
        }
    }

    /// Finds the shares of a leaf.
    void FindShares(const Task &task, GuideCells::Leaf *leaf) const {
        struct Judged {
            double square, bsdfPdf, guidePdf;
            double plainSquare;  ///< of what the BSDF alone would have found
        };
        leaf->targets = task.targets[kAll];
        std::vector<Judged> judged[2];
        for (size_t i = task.begin; i < task.end; ++i) {
            const GuideRecord &r = *records_[i].record;
            if (!(r.bsdfPdf > 0)) continue;
            GuideDirections directions;
            directions.Prepare(task.targets[r.isOfFirstHalf ? 1 : 0], r.p, r.normal, r.bothSides);
            const auto found = static_cast<double>(r.found), pdf = static_cast<double>(r.pdf),
                       bsdfPdf = static_cast<double>(r.bsdfPdf);
            judged[r.isGlossy ? 1 : 0].push_back({found * found * records_[i].counts * pdf, bsdfPdf,
                                                  static_cast<double>(directions.Pdf(r.wi)),
                                                  found * found * pdf / bsdfPdf});
        }
        for (size_t kind = 0; kind < 2; ++kind) {
            if (judged[kind].size() < kMinJudges) continue;
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
            double best = kMinGain * plain;
            for (int i = 1; i <= kShares; ++i) {
                const Float share = largestShare_ * static_cast<Float>(i) / kShares;
                const double moment = momentAt(static_cast<double>(share));
                if (moment >= best) continue;
                best = moment;
                leaf->share[kind] = share;
            }
            if (leaf->share[kind] == 0) continue;
            double all = 0, plainMoment = 0;
            for (const Judged &j : judged[kind]) all += j.plainSquare;
            for (const Judged &j : judged[kind]) plainMoment += std::min(j.plainSquare, kLargestPart * all);
            leaf->gain[kind] =
                static_cast<Float>(plainMoment * (1 - best / plain) / static_cast<double>(task.kindBounces[kind]));
        }
    }

    /// Makes leaves of nodes below which nothing guides. True: the node is such a leaf.
    bool Collapse(size_t node) {
        const GuideCells::Node n = cells_.nodes_[node];
        if (n.axis == 3) return !cells_.leaves_[n.below].Guides();
        const bool first = Collapse(n.below), second = Collapse(n.below + 1);
        if (!first || !second) return false;
        cells_.nodes_[node] = cells_.nodes_[n.below];
        return true;
    }

    std::span<const GuideRecord> places_;
    std::vector<Entry> records_;  ///< of what found something
    const Float largestShare_;
    GuideCells &cells_;
    std::vector<Task> tasks_;  ///< one for each leaf
    std::vector<uint32_t> bounces_;
    std::vector<GuideTarget> targets_[kParts];
};

void GuideCells::Learn(std::span<const GuideRecord> records, Float largestShare) {
    GuideCellsBuilder(records, largestShare, this).Build();
}

void GuideCells::LeavesChanged() {
    largestGain_ = 0;
    for (const Leaf &leaf : leaves_) largestGain_ = std::max({largestGain_, leaf.gain[0], leaf.gain[1]});
}

Float GuideCells::ShinesAt(const Point3 &p) const {
    Float radiance = 0, brightest = 0;
    for (const GuideTarget &target : targets_) {
        brightest = std::max(brightest, target.radiance);
        if (LengthSquared(target.p - p) <= target.r2) radiance = std::max(radiance, target.radiance);
    }
    return radiance > 0 ? radiance / brightest : 0;
}

void GuideCells::Save(StateWriter &out) const {
    out.Vector(nodes_);
    out.Vector(leaves_);
    out.Vector(targets_);
}

void GuideCells::Load(StateReader &in) {
    in.Vector(&nodes_);
    in.Vector(&leaves_);
    in.Vector(&targets_);
    for (size_t i = 0; i < nodes_.size(); ++i) {
        const Node &node = nodes_[i];
        const bool isLeaf = node.axis == 3;
        if (node.axis > 3 ||
            (isLeaf ? node.below >= leaves_.size() : node.below <= i || node.below + 1 >= nodes_.size()))
            in.Refuse();
    }
    for (const Leaf &leaf : leaves_) {
        for (const size_t kind : {0, 1})
            if (!(leaf.share[kind] >= 0 && leaf.share[kind] < 1 && leaf.gain[kind] >= 0)) in.Refuse();
        if (leaf.targets.count < 0 || leaf.targets.count > GuideTargets::kMost) in.Refuse();
    }
    LeavesChanged();
    if (largestGain_ > 0 && nodes_.empty()) in.Refuse();
}

size_t GuideCells::GuidingCells() const {
    return static_cast<size_t>(std::count_if(leaves_.begin(), leaves_.end(), [](const Leaf &l) { return l.Guides(); }));
}

double GuideCells::MeanShare() const {
    double sum = 0;
    for (const Leaf &leaf : leaves_) sum += static_cast<double>(std::max(leaf.share[0], leaf.share[1]));
    return leaves_.empty() ? 0 : sum / static_cast<double>(leaves_.size());
}

}  // namespace pbrt
