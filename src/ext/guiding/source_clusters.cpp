#include "ext/guiding/guide_cells.h"

#include <limits>
#include <numbers>

#include "pbrt/math/frame.h"
#include "pbrt/math/lanes.h"

namespace ext {
namespace {

/// Sine of the minimum cone half angle, 1.8 degrees: in narrower cones, rounding would decide whether a direction is
/// inside.
constexpr Float kMinSine = 0.0316f;
constexpr Float kMinSine2 = kMinSine * kMinSine;
constexpr size_t kMinSamples = 8;
constexpr size_t kSmallClusters = 256;  ///< approximate number of small clusters before merging
constexpr size_t kPlaces = 128;         ///< positions over which cluster solid angles are averaged

using Ops = SimdOps<GuideDirections::kLanes>;
using F = Ops::F;
F Load(const Float *v) { return Ops::Load(v); }
void Store(const F &v, Float *to) { Ops::Store(v, to); }

/// Offset below `end`, a multiple of `stride`, of the weight that contains *left, in [0, sum of the weights). Makes
/// *left relative to its start. If rounding puts *left past the sum: the last positive weight.
size_t FindWeight(const Float *weights, size_t end, size_t stride, Float *left) {
    size_t last = 0;
    for (size_t k = 0; k < end; k += stride) {
        if (!(weights[k] > 0)) continue;
        last = k;
        if (*left < weights[k]) break;
        *left -= weights[k];
    }
    return last;
}

/// 1 - cos of a cone's half angle, from its squared sine.
Float OneMinusCosine(Float sine2) { return sine2 / (1 + std::sqrt(std::max(Float(0), 1 - sine2))); }

struct Cluster {
    size_t count = 0;
    double moment = 0;  ///< of the mean radiance: integral of its square over directions, summed over positions
    Bounds3 bounds;
    double cost = 0;              ///< cached Cost()
    std::vector<uint32_t> parts;  ///< small clusters merged into it

    Point3 Middle() const { return bounds.low + (bounds.high - bounds.low) * Float(0.5); }
    Float Radius2() const { return LengthSquared(bounds.high - Middle()); }
    /// Contribution to the root of the minimal second moment: the root of its moment times the solid angle it covers,
    /// which is proportional to its squared size.
    double Cost() const { return std::sqrt(moment) * double(Length(bounds.high - bounds.low)); }
};

struct Places {
    std::vector<Point3> some;
    double each = 1;  ///< events represented by each position

    double SolidAngle(const Point3 &middle, Float r2) const {
        double sum = 0;
        for (const Point3 &p : some) {
            const Float l2 = LengthSquared(middle - p);
            sum += l2 > r2 ? double(OneMinusCosine(std::max(r2 / l2, kMinSine2))) : 2;
        }
        return 2 * std::numbers::pi * each * sum;
    }
};

/// Without cost and parts.
Cluster Merged(const Cluster &a, const Cluster &b) {
    return {a.count + b.count, a.moment + b.moment, Union(a.bounds, b.bounds), 0, {}};
}

/// Splits the samples along their largest extent until they are few, or hold a small share of count and flux. The split
/// is at the mean of both, which lies beside a small bright spot and so separates it from its surroundings.
void AddSmallClusters(std::span<RadianceSample> samples, size_t largest, double fluxOfAll, size_t countOfAll,
                      const Places &places, std::vector<Cluster> *clusters) {
    Cluster cluster;
    cluster.count = samples.size();
    double flux = 0;
    for (const RadianceSample &f : samples) {
        cluster.bounds = Union(cluster.bounds, f.target);
        flux += f.radiance * f.perPdf;
    }
    const Vector3 size = cluster.bounds.high - cluster.bounds.low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const auto weightOf = [&](const RadianceSample &f) {
        return f.radiance * f.perPdf / fluxOfAll + 1 / double(countOfAll);
    };
    const double weight = flux / fluxOfAll + double(cluster.count) / double(countOfAll);
    if (samples.size() <= largest || weight < 2 / double(kSmallClusters)) {
        const double meanRadiance = flux / places.SolidAngle(cluster.Middle(), cluster.Radius2());
        cluster.moment = flux * meanRadiance;
        if (!(cluster.moment > 0)) return;
        cluster.parts = {uint32_t(clusters->size())};
        for (RadianceSample &f : samples) {
            f.meanRadiance = meanRadiance;
            f.cluster = cluster.parts[0];
        }
        clusters->push_back(std::move(cluster));
        return;
    }
    double sum = 0;
    for (const RadianceSample &f : samples) sum += weightOf(f) * double(f.target[axis]);
    const auto mean = Float(sum / weight);
    const auto isBelow = [&](const RadianceSample &f) { return f.target[axis] < mean; };
    size_t middle = std::partition(samples.begin(), samples.end(), isBelow) - samples.begin();
    if (std::min(middle, samples.size() - middle) < kMinSamples) {
        middle = std::clamp(middle, kMinSamples, samples.size() - kMinSamples);
        std::ranges::nth_element(samples, samples.begin() + middle, {},
                                 [&](const RadianceSample &f) { return f.target[axis]; });
    }
    AddSmallClusters(samples.first(middle), largest, fluxOfAll, countOfAll, places, clusters);
    AddSmallClusters(samples.subspan(middle), largest, fluxOfAll, countOfAll, places, clusters);
}

/// Repeatedly merges the pair of clusters with the lowest cost increase.
void MergeClusters(std::vector<Cluster> *clusters) {
    struct Partner {
        size_t of = 0;
        double cost = std::numeric_limits<double>::infinity();
    };
    std::vector<Partner> best(clusters->size());
    const auto consider = [&](size_t i, size_t j) {
        const Cluster &a = (*clusters)[i], &b = (*clusters)[j];
        const double cost = i == j ? std::numeric_limits<double>::infinity() : Merged(a, b).Cost() - a.cost - b.cost;
        if (cost < best[i].cost) best[i] = {j, cost};
    };
    const auto find = [&](size_t i) {
        best[i] = {};
        for (size_t j = 0; j < clusters->size(); ++j) consider(i, j);
    };
    for (Cluster &cluster : *clusters) cluster.cost = cluster.Cost();
    for (size_t i = 0; i < clusters->size(); ++i) find(i);
    while (clusters->size() > kMaxSourceClusters) {
        size_t gone = 0;
        for (size_t k = 1; k < clusters->size(); ++k)
            if (best[k].cost < best[gone].cost) gone = k;
        const size_t kept = best[gone].of, last = clusters->size() - 1;
        Cluster merged = Merged((*clusters)[gone], (*clusters)[kept]);
        merged.cost = merged.Cost();
        merged.parts = std::move((*clusters)[kept].parts);
        merged.parts.insert(merged.parts.end(), (*clusters)[gone].parts.begin(), (*clusters)[gone].parts.end());
        (*clusters)[kept] = std::move(merged);
        if (gone != last) (*clusters)[gone] = std::move((*clusters)[last]);
        best[gone] = best[last];
        clusters->pop_back();
        best.pop_back();
        const size_t changed[] = {kept == last ? gone : kept, gone};
        for (size_t k = 0; k < clusters->size(); ++k) {
            const size_t of = best[k].of;
            if (k == changed[0] || of == kept || of == gone || of == last) {
                find(k);
                continue;
            }
            for (const size_t j : changed)
                if (j < clusters->size()) consider(k, j);
        }
    }
}

/// Reorders the clusters by median splits, so that each run of GuideDirections::kLanes lies close together.
void SortByPlace(std::span<Cluster> clusters) {
    constexpr size_t kRun = GuideDirections::kLanes;
    if (clusters.size() <= kRun) return;
    Bounds3 bounds;
    for (const Cluster &cluster : clusters) bounds = Union(bounds, cluster.Middle());
    const Vector3 size = bounds.high - bounds.low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const size_t half = (clusters.size() / kRun + 1) / 2 * kRun;
    std::ranges::nth_element(clusters, clusters.begin() + half, {},
                             [axis](const Cluster &cluster) { return cluster.Middle()[axis]; });
    SortByPlace(clusters.first(half));
    SortByPlace(clusters.subspan(half));
}

}  // namespace

std::vector<SourceCluster> MakeSourceClusters(std::span<RadianceSample> samples, std::span<const Point3> from,
                                              size_t bounces) {
    Places places;
    const size_t stride = (from.size() + kPlaces - 1) / kPlaces;
    for (size_t i = 0; i < from.size(); i += stride) places.some.push_back(from[i]);
    places.each = double(bounces) / double(places.some.size());
    const auto nothing =
        std::partition(samples.begin(), samples.end(), [](const RadianceSample &f) { return f.radiance > 0; });
    const auto positive = samples.first(nothing - samples.begin());
    if (positive.size() < kMinSamples) return {};
    std::vector<Cluster> clusters;
    double flux = 0;
    for (const RadianceSample &f : positive) flux += f.radiance * f.perPdf;
    AddSmallClusters(positive, 2 * kMinSamples, flux, positive.size(), places, &clusters);
    std::vector<uint32_t> mergedInto(clusters.size());
    MergeClusters(&clusters);
    SortByPlace(clusters);
    std::vector<SourceCluster> made;
    for (const Cluster &cluster : clusters) {
        for (const uint32_t part : cluster.parts) mergedInto[part] = uint32_t(made.size());
        made.push_back({cluster.Middle(), 0, 0});
    }
    for (RadianceSample &f : positive) {
        if (f.cluster == RadianceSample::kNone) continue;
        f.cluster = mergedInto[f.cluster];
        SourceCluster &target = made[f.cluster];
        target.r2 = std::max(target.r2, LengthSquared(f.target - target.p));
    }
    for (size_t k = 0; k < made.size(); ++k)
        made[k].radiance = Float(std::sqrt(clusters[k].moment / places.SolidAngle(made[k].p, made[k].r2)));
    return made;
}

Float SolidAngleOf(const SourceCluster &target, const Point3 &p, const Vector3 &n, bool bothSides) {
    if (target.Contains(p)) return 0;
    const Vector3 d = target.p - p;
    const Float l2 = LengthSquared(d);
    const Float sine2 = std::max(target.r2 / l2, kMinSine2);
    const Float facing = bothSides ? 1 : std::min(Dot(d, n) / std::sqrt(l2) + std::sqrt(sine2), Float(1));
    return facing > 0 ? 2 * Pi * OneMinusCosine(sine2) * facing : 0;
}

SourceClusters::SourceClusters(std::span<const SourceCluster> made) : count(made.size()) {
    for (size_t k = 0; k < count; ++k) {
        x[k] = made[k].p.x;
        y[k] = made[k].p.y;
        z[k] = made[k].p.z;
        r[k] = std::sqrt(made[k].r2);
    }
}

void GuideDirections::Prepare(const SourceClusters &made, const PerSourceCluster &radiances, const Point3 &p,
                              const Vector3 &n, bool bothSides) {
    static_assert(kMaxSourceClusters % kLanes == 0);
    const F px(p.x), py(p.y), pz(p.z), nx(n.x), ny(n.y), nz(n.z), minFacing(bothSides ? Float(1) : Float(0));
    const auto radianceOf = [&](size_t from) { return Ops::Load(&radiances[from]); };
    // The groups of kLanes clusters that are not all dark.
    std::array<size_t, kMaxSourceClusters / kLanes> groups{};
    size_t used = 0;
    for (size_t from = 0; from < made.count; from += kLanes) {
        groups[used] = from;
        used += Ops::Any(radianceOf(from) > F(0)) ? 1 : 0;
    }
    F sum(0);
    for (size_t i = 0; i < used; ++i) {
        const size_t from = groups[i], k = i * kLanes;
        const F dx = Load(&made.x[from]) - px, dy = Load(&made.y[from]) - py, dz = Load(&made.z[from]) - pz;
        const F l2 = Ops::Max(dx * dx + dy * dy + dz * dz, F(std::numeric_limits<Float>::min()));
        const F perLength = F(1) / Ops::Sqrt(l2);
        const F sine = Ops::Max(Load(&made.r[from]) * perLength, F(kMinSine));
        const F facing = Ops::Max(minFacing, Ops::Min((dx * nx + dy * ny + dz * nz) * perLength + sine, F(1)));
        const F cosine = Ops::Sqrt(Ops::Max(F(1) - sine * sine, F(0)));
        const F weight = Ops::Select(sine < F(1), radianceOf(from) * facing, F(0));
        const F weightOfCone = weight * F(2 * Pi) * (F(1) - cosine);
        Store(dx * perLength, &x_[k]);
        Store(dy * perLength, &y_[k]);
        Store(dz * perLength, &z_[k]);
        Store(cosine, &cosine_[k]);
        Store(weight, &weight_[k]);
        Store(weightOfCone, &weightOfCone_[k]);
        sum += weightOfCone;
    }
    Store(sum, laneSums_.data());
    total_ = Ops::Sum(sum);
    end_ = total_ > 0 && std::isfinite(total_) ? used * kLanes : 0;
    perTotal_ = IsUsable() ? 1 / total_ : 0;
}

Vector3 GuideDirections::Sample(const Point2 &u) const {
    Float left = u.x * total_;
    const size_t lane = FindWeight(laneSums_.data(), kLanes, 1, &left);
    const size_t k = lane + FindWeight(&weightOfCone_[lane], end_ - lane, kLanes, &left);
    const Float along = std::clamp(left / weightOfCone_[k], Float(0), OneMinusEpsilon);
    const Float z = 1 - along * (1 - cosine_[k]);
    return Frame::FromZ({x_[k], y_[k], z_[k]}).FromLocal(SphericalDirectionOfTurn(SafeSqrt(1 - z * z), z, u.y));
}

Float GuideDirections::Pdf(const Vector3 &w) const {
    const F x(w.x), y(w.y), z(w.z);
    F sum(0);
    for (size_t k = 0; k < end_; k += kLanes) {
        const F cosine = x * Load(&x_[k]) + y * Load(&y_[k]) + z * Load(&z_[k]);
        sum += Ops::Select(cosine >= Load(&cosine_[k]), Load(&weight_[k]), F(0));
    }
    return Ops::Sum(sum) * perTotal_;
}

}  // namespace ext
