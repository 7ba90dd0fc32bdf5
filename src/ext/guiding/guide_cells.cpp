#include "ext/guiding/guide_cells.h"

#include <numbers>
#include <utility>

#include "pbrt/core/parallel.h"

namespace ext {
namespace {

constexpr size_t kCellRecords = 256;     ///< cells with more records of positive contribution are split
constexpr double kMaxRecordShare = 0.1;  ///< outlier limit: maximum share of one record in a second moment
/// Weight of the parent cell's radiance estimate for a cluster, in samples.
constexpr double kPriorSamples = 3;
/// Groups of GuideDirections::kLanes clusters are left out of a cell if BSDF sampling suffices for them: with density
/// 1/Pi (solid angle), their second moment is at most this fraction of the squared flux, the smallest moment of all.
constexpr double kMaxOmitted = 0.02;
constexpr size_t kCellPlaces = 32;  ///< vertices per cell over which cluster solid angles are averaged
constexpr size_t kFrom = 1024;      ///< approximate number of vertices passed to MakeSourceClusters
constexpr size_t kMinTests = 32;    ///< minimum number of records for a guiding probability
/// Weight of the parent cell's estimate of the guiding probability, in scattering events.
constexpr double kPriorBounces = 2048;
/// Minimum relative reduction of the second moment: smaller gains occur by chance, even under uniform illumination.
constexpr double kMinGain = 0.03;
constexpr size_t kProbabilities = 8;  ///< tested, including 0

}  // namespace

class GuideCellsBuilder {
  public:
    GuideCellsBuilder(std::span<const GuideRecord> places, Float largestProbability, GuideCells *cells)
        : places_(places), largestProbability_(largestProbability), cells_(*cells) {
        for (const GuideRecord &place : places)
            if (place.contribution > 0) records_.push_back({.record = &place});
    }

    void Build() {
        cells_.Clear();
        if (records_.empty()) return;
        ParallelForEach(kSubsets, [&](int64_t subset) { MakeClusters(subset); });
        cells_.tree_.Begin(1);
        Divide(0, 0, records_.size());
        cells_.leaves_.resize(tasks_.size());
        cells_.radiances_.resize(tasks_.size());
        SortBounces();
        ParallelForEach(kSubsets, [&](int64_t subset) { EstimateRadiances(subset); });
        tested_.resize(records_.size());
        ParallelForEach(tasks_.size(), [&](int64_t i) {
            const Task &task = tasks_[i];
            cells_.radiances_[i].perCluster = task.radiances[kAll];
            Test(task);
        });
        for (const size_t kind : {0, 1}) EstimateProbabilities(kind, 0, {});
        Collapse(0);
        if (const PointTree::Node &root = cells_.tree_.Nodes()[0];
            root.IsLeaf() && !cells_.leaves_[root.below].Guides())
            return cells_.Clear();
        cells_.clusters_ = std::move(clusters_[kAll]);
        cells_.LeavesChanged();
    }

  private:
    static constexpr size_t kAll = 2, kSubsets = 3;  ///< the two halves of the records, and their union
    struct Entry {
        const GuideRecord *record;
        double counts = 0;  ///< weight of its square: mean radiance from its direction over its own
        uint32_t cluster[kSubsets] = {RadianceSample::kNone, RadianceSample::kNone, RadianceSample::kNone};
        double flux[kSubsets] = {};  ///< radiance times cosine over density, clamped
    };
    /// Second moment of a record with each guiding probability, and with BSDF sampling alone.
    struct Tested {
        std::array<double, kProbabilities> squares{};  ///< contribution to the second moment, per guiding probability
        double plainSquare = 0;
    };
    /// Over the scattering events of a cell, for BSDFs of one kind.
    struct Moments {
        double each = 0;                               ///< mean second moment of an event without guiding
        double plain = 0;                              ///< with BSDF sampling alone
        std::array<double, kProbabilities> squares{};  ///< relative second moment per guiding probability
    };
    struct Content {
        size_t begin = 0, end = 0;   ///< range in records_
        size_t kindBounces[2] = {};  ///< events at BSDFs without and with glossy lobes
    };
    struct Task {
        size_t begin, end;                    ///< range in records_
        size_t firstBounce = 0, bounces = 0;  ///< range in bounces_
        PerSourceCluster radiances[kSubsets] = {};
    };

    static bool IsOf(const GuideRecord &r, size_t subset) { return subset == kAll || r.isOfFirstHalf == (subset == 0); }
    static size_t KindOf(const GuideRecord &r) { return r.isGlossy ? 1 : 0; }
    static double CosineOf(const GuideRecord &r) { return r.bothSides ? 1 : double(std::abs(Dot(r.wi, r.normal))); }

    void MakeClusters(size_t subset) {
        std::vector<RadianceSample> samples;
        std::vector<Point3> from;
        double sum = 0;
        uint32_t number = 0;
        size_t bounces = 0;
        const size_t step = std::max<size_t>(1, places_.size() / kFrom);
        for (size_t i = 0; i < places_.size(); ++i) {
            const GuideRecord &r = places_[i];
            const uint32_t at = number;
            number += r.contribution > 0;
            if (!(r.pdf > 0) || !IsOf(r, subset)) continue;
            if (bounces++ % step == 0) from.push_back(r.p);
            if (!(r.contribution > 0 && r.radiance > 0)) continue;
            const double perPdf = 1 / double(r.pdf);
            samples.push_back({.target = r.target, .radiance = double(r.radiance), .perPdf = perPdf, .number = at});
            sum += samples.back().radiance * perPdf;
        }
        for (RadianceSample &f : samples) f.radiance = std::min(f.radiance, kMaxRecordShare * sum / f.perPdf);
        clusters_[subset] = MakeSourceClusters(samples, from, bounces);
        sideBySide_[subset] = SourceClusters(clusters_[subset]);
        // Single radiances have high variance; the cluster mean replaces them.
        std::vector<double> radiances(clusters_[subset].size()), counts(radiances.size());
        for (const RadianceSample &f : samples)
            if (f.cluster != RadianceSample::kNone) {
                radiances[f.cluster] += f.radiance;
                ++counts[f.cluster];
            }
        for (const RadianceSample &f : samples) {
            if (!(f.radiance > 0)) continue;
            Entry &entry = records_[f.number];
            entry.cluster[subset] = f.cluster;
            if (f.cluster != RadianceSample::kNone)
                entry.flux[subset] = radiances[f.cluster] / counts[f.cluster] * f.perPdf * CosineOf(*entry.record);
            if (subset == kAll) entry.counts = std::min(1.0, f.meanRadiance / f.radiance);
        }
    }

    void Divide(size_t node, size_t begin, size_t end) {
        contents_.resize(cells_.tree_.Nodes().size());
        contents_[node].begin = begin;
        contents_[node].end = end;
        size_t second = begin;
        const auto pointOf = [](const Entry &e) { return e.record->p; };
        if (const auto first = records_.begin(); end - begin > kCellRecords)
            second = cells_.tree_.Divide(node, first + begin, first + end, pointOf) - first;
        if (second == begin) {
            cells_.tree_.MakeLeaf(node, tasks_.size());
            tasks_.push_back({.begin = begin, .end = end});
            return;
        }
        const size_t below = cells_.tree_.Nodes()[node].below;
        Divide(below, begin, second);
        Divide(below + 1, second, end);
    }

    /// Sorts all scattering events by task, including those without contribution.
    void SortBounces() {
        std::vector<uint32_t> leaves(places_.size());
        for (size_t i = 0; i < places_.size(); ++i) {
            if (!(places_[i].pdf > 0)) continue;
            leaves[i] = cells_.tree_.LeafOf(places_[i].p);
            ++tasks_[leaves[i]].bounces;
        }
        size_t sum = 0;
        for (Task &task : tasks_) task.firstBounce = std::exchange(sum, sum + task.bounces);
        bounces_.resize(sum);
        std::vector<size_t> next;
        for (const Task &task : tasks_) next.push_back(task.firstBounce);
        for (size_t i = 0; i < places_.size(); ++i)
            if (places_[i].pdf > 0) bounces_[next[leaves[i]]++] = uint32_t(i);
        const std::vector<PointTree::Node> &nodes = cells_.tree_.Nodes();
        for (size_t node = nodes.size(); node-- > 0;) {
            size_t *const kinds = contents_[node].kindBounces;
            const size_t below = nodes[node].below;
            if (nodes[node].IsLeaf())
                for (size_t i = 0; i < tasks_[below].bounces; ++i)
                    ++kinds[KindOf(places_[bounces_[tasks_[below].firstBounce + i]])];
            else
                for (const size_t kind : {0, 1})
                    kinds[kind] = contents_[below].kindBounces[kind] + contents_[below + 1].kindBounces[kind];
        }
    }

    /// Sampled and expected flux per tree node and cluster of a subset (node-major).
    struct Sums {
        std::vector<double> sampled, expected;
        std::vector<double> events;      ///< of the subset; per node, of leaves only
        std::vector<double> meanSample;  ///< per cluster
    };

    /// Estimates cluster radiances per task as sampled over expected flux, top-down. Sparse cells shrink to their
    /// parent's estimate.
    void EstimateRadiances(size_t subset) {
        const std::vector<SourceCluster> &clusters = clusters_[subset];
        const size_t count = clusters.size();
        if (count == 0) return;
        const std::vector<PointTree::Node> &nodes = cells_.tree_.Nodes();
        const Sums sums = SumSamples(subset);
        std::vector<double> factor(nodes.size() * count);
        std::fill_n(factor.begin(), count, 1.0);
        for (size_t node = 0; node < nodes.size(); ++node) {
            for (size_t k = 0; k < count; ++k) {
                const double prior = kPriorSamples * sums.meanSample[k];
                double &a = factor[node * count + k];  // holds the parent's value here
                const double f = sums.sampled[node * count + k] + prior;
                a = f > 0 && a > 0 ? f / (sums.expected[node * count + k] + prior / a) : 0;
            }
            const size_t below = nodes[node].below;
            if (nodes[node].IsLeaf()) {
                PerSourceCluster &radiances = tasks_[below].radiances[subset];
                std::vector<double> flux(count);
                for (size_t k = 0; k < count; ++k) {
                    const double a = factor[node * count + k];
                    radiances[k] = Float(a * double(clusters[k].radiance));
                    flux[k] = a * sums.expected[node * count + k] / sums.events[node];
                }
                if (sums.events[node] > 0) OmitWeakGroups(flux, &radiances);
            } else {
                for (size_t child = below; child < below + 2; ++child)
                    std::copy_n(&factor[node * count], count, &factor[child * count]);
            }
        }
    }

    /// Sets the radiances of the weakest groups (kMaxOmitted) to 0. `flux`: expected per event, of each cluster.
    static void OmitWeakGroups(std::span<const double> flux, PerSourceCluster *radiances) {
        constexpr size_t kSize = GuideDirections::kLanes;
        std::array<std::pair<double, size_t>, kMaxSourceClusters / kSize> groups{};  // moment, first cluster
        for (size_t k = 0; k < radiances->size(); k += kSize) groups[k / kSize].second = k;
        double sum = 0;
        for (size_t k = 0; k < flux.size(); ++k) {
            groups[k / kSize].first += std::numbers::pi * flux[k] * double((*radiances)[k]);
            sum += flux[k];
        }
        if (!(sum > 0)) return;
        std::ranges::sort(groups);
        double omitted = 0;
        for (const auto &[moment, first] : groups) {
            omitted += moment;
            if (!(omitted <= kMaxOmitted * sum * sum)) return;
            std::fill_n(radiances->begin() + first, kSize, Float(0));
        }
    }

    Sums SumSamples(size_t subset) const {
        const std::vector<SourceCluster> &clusters = clusters_[subset];
        const size_t count = clusters.size();
        const std::vector<PointTree::Node> &nodes = cells_.tree_.Nodes();
        Sums sums;
        sums.sampled.resize(nodes.size() * count);
        sums.expected.resize(nodes.size() * count);
        sums.events.resize(nodes.size());
        sums.meanSample.resize(count);
        std::vector<double> samples(count);
        for (size_t node = nodes.size(); node-- > 0;) {
            double *const f = &sums.sampled[node * count], *const e = &sums.expected[node * count];
            const size_t below = nodes[node].below;
            if (!nodes[node].IsLeaf()) {
                const double *const f0 = &sums.sampled[below * count], *const e0 = &sums.expected[below * count];
                for (size_t k = 0; k < count; ++k) {
                    f[k] = f0[k] + f0[count + k];
                    e[k] = e0[k] + e0[count + k];
                }
                continue;
            }
            const Task &task = tasks_[below];
            for (size_t i = task.begin; i < task.end; ++i) {
                const Entry &entry = records_[i];
                const uint32_t cluster = entry.cluster[subset];
                // Inside a cluster the expected flux is 0 (SolidAngleOf), so its samples are excluded.
                if (cluster == RadianceSample::kNone || clusters[cluster].Contains(entry.record->p)) continue;
                f[cluster] += entry.flux[subset];
                sums.meanSample[cluster] += entry.flux[subset];
                ++samples[cluster];
            }
            std::vector<double> angles(count);
            const size_t step = std::max<size_t>(1, task.bounces / kCellPlaces);
            size_t places = 0;
            for (size_t i = 0; i < task.bounces; i += step, ++places) {
                const GuideRecord &r = places_[bounces_[task.firstBounce + i]];
                for (size_t k = 0; k < count; ++k)
                    angles[k] += double(SolidAngleOf(clusters[k], r.p, r.normal, r.bothSides));
            }
            for (double &angle : angles)
                if (places > 0) angle /= double(places);
            double &events = sums.events[node];
            for (size_t i = 0; i < task.bounces; ++i) events += IsOf(places_[bounces_[task.firstBounce + i]], subset);
            for (size_t k = 0; k < count; ++k) e[k] = events * double(clusters[k].radiance) * angles[k];
        }
        for (size_t k = 0; k < count; ++k)
            if (samples[k] > 0) sums.meanSample[k] /= samples[k];
        return sums;
    }

    Float ProbabilityAt(size_t k) const { return largestProbability_ * Float(k) / (kProbabilities - 1); }

    void Test(const Task &task) {
        for (size_t i = task.begin; i < task.end; ++i) {
            const GuideRecord &r = *records_[i].record;
            if (!(r.bsdfPdf > 0)) continue;
            GuideDirections directions;
            const size_t other = r.isOfFirstHalf ? 1 : 0;
            directions.Prepare(sideBySide_[other], task.radiances[other], r.p, r.normal, r.bothSides);
            const auto contribution = double(r.contribution), pdf = double(r.pdf), bsdfPdf = double(r.bsdfPdf),
                       guidePdf = double(directions.Pdf(r.wi));
            const double square = contribution * contribution * records_[i].counts * pdf;
            for (size_t k = 0; k < kProbabilities; ++k) {
                const auto share = double(ProbabilityAt(k));
                tested_[i].squares[k] = square / ((1 - share) * bsdfPdf + share * guidePdf);
            }
            tested_[i].plainSquare = contribution * contribution * pdf / bsdfPdf;
        }
    }

    /// Estimates the guiding probability of all leaves below a node for one kind of BSDF. Sparse cells follow their
    /// parent, because rare contributions dominate the second moment.
    void EstimateProbabilities(size_t kind, size_t node, const Moments &above) {
        const Content &content = contents_[node];
        const double prior = node == 0 ? 0 : kPriorBounces;
        double squares = prior * above.each, plain = prior * above.plain;
        size_t tests = 0;
        for (size_t i = content.begin; i < content.end; ++i) {
            if (KindOf(*records_[i].record) != kind) continue;
            ++tests;
            squares += tested_[i].squares[0];
            plain += tested_[i].plainSquare;
        }
        if (node == 0 && tests < kMinTests) return;
        const double maxSquares = kMaxRecordShare * squares, maxPlain = kMaxRecordShare * plain;
        Moments here;
        for (size_t k = 0; k < kProbabilities; ++k) here.squares[k] = prior * above.each * above.squares[k];
        here.plain = prior * above.plain;
        for (size_t i = content.begin; i < content.end; ++i) {
            const Tested &tested = tested_[i];
            if (KindOf(*records_[i].record) != kind || !(tested.squares[0] > 0)) continue;
            const double scale = std::min(1.0, maxSquares / tested.squares[0]);
            for (size_t k = 0; k < kProbabilities; ++k) here.squares[k] += scale * tested.squares[k];
            here.plain += std::min(tested.plainSquare, maxPlain);
        }
        if (!(here.squares[0] > 0)) return;
        const double bounces = prior + double(content.kindBounces[kind]);
        here.each = here.squares[0] / bounces;
        here.plain /= bounces;
        // In reverse: squares[0], without guiding, is the divisor.
        for (size_t k = kProbabilities; k-- > 0;) here.squares[k] /= here.squares[0];
        const PointTree::Node &n = cells_.tree_.Nodes()[node];
        if (!n.IsLeaf()) {
            EstimateProbabilities(kind, n.below, here);
            return EstimateProbabilities(kind, size_t{n.below} + 1, here);
        }
        const auto best = std::min_element(here.squares.begin(), here.squares.end());
        if (*best > 1 - kMinGain) return;
        GuideCells::Leaf &leaf = cells_.leaves_[n.below];
        leaf.probability[kind] = ProbabilityAt(best - here.squares.begin());
        leaf.gain[kind] = Float(here.plain * (1 - *best));
    }

    /// Turns nodes into leaves if nothing below them is guided. Returns true if `node` is such a leaf.
    bool Collapse(size_t node) {
        const PointTree::Node n = cells_.tree_.Nodes()[node];
        if (n.IsLeaf()) return !cells_.leaves_[n.below].Guides();
        const bool first = Collapse(n.below), second = Collapse(n.below + 1);
        if (!first || !second) return false;
        cells_.tree_.MakeLeaf(node, cells_.tree_.Nodes()[n.below].below);
        return true;
    }

    std::span<const GuideRecord> places_;
    std::vector<Entry> records_;  ///< with positive contribution
    const Float largestProbability_;
    GuideCells &cells_;
    std::vector<Task> tasks_;        ///< one per leaf
    std::vector<Content> contents_;  ///< one per node
    std::vector<Tested> tested_;     ///< one per entry of records_
    std::vector<uint32_t> bounces_;
    std::vector<SourceCluster> clusters_[kSubsets];
    SourceClusters sideBySide_[kSubsets];  ///< clusters_ as structure of arrays
};

void GuideCells::Learn(std::span<const GuideRecord> records, Float largestProbability) {
    GuideCellsBuilder(records, largestProbability, this).Build();
}

}  // namespace ext
