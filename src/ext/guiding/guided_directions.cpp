#include "ext/guiding/guided_directions.h"

namespace ext {
namespace {

/// Requests the cache lines of a cell's radiances. The line of the first may be skipped: GuideCells::At
/// has read the probability in it.
void Prefetch(const PerSourceCluster &values) {
    constexpr size_t kPerLine = 64 / sizeof(Float);
    for (size_t k = kPerLine - 1; k < values.size(); k += kPerLine) __builtin_prefetch(&values[k]);
}

}  // namespace

void GuidedDirections::SetSource(Float distance) {
    GuideRecord &record = bounces_[pendingBounces_ - 1].record;
    record.target = record.p + record.wi * distance;
    seeksSource_ = false;
}

void GuidedDirections::RecordHit(const PathVertex &vertex) {
    if (!seeksSource_) return;
    way_ += Distance(at_, vertex.point.p);
    at_ = vertex.point.p;
    // Sources behind mirrors lie at the unfolded path length.
    const BxdfFlags flags = vertex.bsdf.Flags();
    if (IsNonSpecular(flags) || !IsSpecular(flags)) SetSource(way_);
}

void GuidedDirections::RecordHitInMedium(const Point3 &p) {
    if (seeksSource_) SetSource(way_ + Distance(at_, p));
}

void GuidedDirections::PrepareDirections(const PathVertex &vertex, const SampledSpectrum &beta) {
    const auto &[point, bsdf] = vertex;
    guidingProbability_ = 0;
    unprepared_ = nullptr;
    isGuided_ = false;
    if (!guide_.EstimatesDirections()) return;
    const bool isRecorded = places_.next + pendingBounces_ < places_.end;
    if (!isRecorded && !guide_.Cells().Guide()) return;
    beta_ = beta.Average();
    const Float importance = Sqr(beta_ * pixelImportance_);
    if (!(isRecorded || guide_.Cells().MayGuide(importance)) || !PathGuide::Guides(bsdf)) return;
    isGuided_ = true;
    isGlossy_ = Has(bsdf.Flags(), BxdfFlags::Glossy);
    bothSides_ = IsTransmissive(bsdf.Flags());
    normal_ = FaceForward(point.shading.n, point.wo);
    Float probability = 0;
    unprepared_ = guide_.Cells().At(point.p, isGlossy_, importance, &probability);
    if (!unprepared_) return;
    guidingProbability_ = probability;
    Prefetch(*unprepared_);
}

void GuidedDirections::PrepareOnce(const PathVertex &vertex) {
    if (!unprepared_) return;
    directions_.Prepare(guide_.Cells().Clusters(), *unprepared_, vertex.point.p, normal_, bothSides_);
    unprepared_ = nullptr;
    if (!directions_.IsUsable()) guidingProbability_ = 0;
}

Float GuidedDirections::Pdf(const PathVertex &vertex, const Vector3 &wi) {
    PrepareOnce(vertex);
    const Float pdf = vertex.bsdf.Pdf(vertex.point.wo, wi);
    return guidingProbability_ > 0 ? (1 - guidingProbability_) * pdf + guidingProbability_ * directions_.Pdf(wi) : pdf;
}

std::optional<BsdfSample> GuidedDirections::Sample(const PathVertex &vertex, Float uc, const Point2 &u) {
    PrepareOnce(vertex);
    const auto &[point, bsdf] = vertex;
    if (!(guidingProbability_ > 0)) return bsdf.Sample(point.wo, uc, u);
    std::optional<BsdfSample> sample;
    if (uc < guidingProbability_) {
        const Vector3 wi = directions_.Sample(u);
        const SampledSpectrum f = bsdf.FOfSamples(point.wo, wi);
        if (!f) return sample;
        const Float guidePdf = directions_.Pdf(wi);
        if (!(guidePdf > 0)) return sample;
        const bool transmits = (Dot(wi, point.shading.n) < 0) != (Dot(point.wo, point.shading.n) < 0);
        const BxdfFlags side = transmits ? BxdfFlags::Transmission : BxdfFlags::Reflection;
        sample = {.f = f,
                  .wi = wi,
                  .pdf = (1 - guidingProbability_) * bsdf.Pdf(point.wo, wi) + guidingProbability_ * guidePdf,
                  .flags = side | (isGlossy_ ? BxdfFlags::Glossy : BxdfFlags::Diffuse)};
        return sample;
    }
    sample =
        bsdf.Sample(point.wo, std::min((uc - guidingProbability_) / (1 - guidingProbability_), OneMinusEpsilon), u);
    if (!sample) return sample;
    if (IsSpecular(sample->flags)) {
        sample->pdf *= 1 - guidingProbability_;
        return sample;
    }
    // One-sample MIS of two techniques with the balance heuristic. The weights use Bsdf::Pdf for both, which may differ
    // from the BSDF's sampling density; they sum to one regardless.
    const Float bsdfPdf = sample->pdfIsProportional ? bsdf.Pdf(point.wo, sample->wi) : sample->pdf;
    const Float guidePdf = directions_.Pdf(sample->wi);
    const Float pdf = (1 - guidingProbability_) * bsdfPdf + guidingProbability_ * guidePdf;
    if (!(pdf > 0)) {
        sample->pdf *= 1 - guidingProbability_;
        return sample;
    }
    sample->f *= bsdfPdf / sample->pdf;
    sample->pdf = pdf;
    sample->pdfIsProportional = false;
    return sample;
}

void GuidedDirections::RecordScatter(const PathVertex &vertex, const BsdfSample &sample, Float pdf,
                                     const SampledSpectrum &L, const SampledSpectrum &beta) {
    if (seeksSource_) SetSource(way_);
    if (!isGuided_ || places_.next + pendingBounces_ >= places_.end || pendingBounces_ == kMaxPendingBounces) return;
    seeksSource_ = true;
    way_ = 0;
    at_ = vertex.point.p;
    PendingBounce &open = bounces_[pendingBounces_++];
    open.L = L;
    open.beta = beta;
    open.record = {.p = vertex.point.p,
                   .normal = normal_,
                   .wi = sample.wi,
                   .pdf = pdf,
                   .bsdfPdf = guidingProbability_ > 0 ? vertex.bsdf.Pdf(vertex.point.wo, sample.wi) : pdf,
                   .beta = beta_,
                   .bothSides = bothSides_,
                   .isGlossy = isGlossy_};
}

Float GuidedDirections::ContinuationProbability(const PathVertex &vertex, Float beta) {
    if (!IsNonSpecular(vertex.bsdf.Flags())) {
        cell_ = {};
        return 0;
    }
    return ContinuationProbabilityIn(roulette_->At(vertex.point.p, PathRoulette::KindOf(vertex)), beta);
}

Float GuidedDirections::ContinuationProbabilityInMedium(const Point3 &p, Float beta) {
    return ContinuationProbabilityIn(roulette_->At(p, PathRoulette::kInMedium), beta);
}

Float GuidedDirections::ContinuationProbabilityIn(const PathRoulette::Cell &cell, Float beta) {
    cell_ = cell;
    return PathRoulette::ContinuationProbability(
        cell.here, beta * pixelImportance_, std::min(PathRoulette::kMinContinuation / continuationAfterNee_, Float(1)));
}

Float GuidedDirections::ContinuationProbabilityAfterNee(Float beta) {
    const Float continuation = PathRoulette::ContinuationProbability(cell_.onwards, beta * pixelImportance_);
    continuationAfterNee_ = continuation > 0 ? continuation : 1;
    return continuationAfterNee_;
}

void GuidedDirections::BeginScattering(const SampledSpectrum &beta, const SampledSpectrum &L) {
    if (isPending_) {
        PendingVertex &v = vertices_[pendingVertices_ - 1];
        v.onwards = {L, beta.Average(), cost_};
        isPending_ = false;
    }
    cost_ += PathCost::kBounce;
}

void GuidedDirections::BeginVertexAt(const Point3 &p, uint32_t kind, const SampledSpectrum &beta,
                                     const SampledSpectrum &L) {
    const PendingVertex::Before here{L, beta.Average(), cost_};
    cost_ += PathCost::kLight;
    isPending_ = roulette_ && path_ && pendingVertices_ < vertices_.size() && here.beta > 0;
    if (isPending_) vertices_[pendingVertices_++] = {p, kind, here, {}};
}

void GuidedDirections::BeginVertex(const PathVertex &vertex, const SampledSpectrum &beta, const SampledSpectrum &L) {
    BeginVertexAt(vertex.point.p, PathRoulette::KindOf(vertex), beta, L);
}

void GuidedDirections::BeginVertexInMedium(const Point3 &p, const SampledSpectrum &beta, const SampledSpectrum &L) {
    BeginVertexAt(p, PathRoulette::kInMedium, beta, L);
}

void GuidedDirections::End(const SampledSpectrum &L) {
    if (seeksSource_) SetSource(guide_.EnvironmentDistance());
    for (size_t i = 0; i < pendingBounces_; ++i) {
        PendingBounce &open = bounces_[i];
        const SampledSpectrum added = L - open.L;
        open.record.contribution = added.Average() / open.record.beta;
        Float radiance = 0;
        for (int k = 0; k < SpectrumSamples; ++k)
            if (open.beta[k] > 0) radiance += added[k] / open.beta[k];
        open.record.radiance = radiance / SpectrumSamples;
        if (open.record.pdf > 0 && open.record.radiance >= 0 && open.record.contribution >= 0 &&
            std::isfinite(open.record.radiance * open.record.radiance / open.record.pdf) &&
            std::isfinite(open.record.contribution * open.record.contribution * open.record.pdf))
            guide_.Record(places_, open.record);
    }
    pendingBounces_ = 0;
    if (!roulette_ || !path_) return;
    for (size_t i = 0; i < std::min(pendingVertices_, roulette_->Vertices()); ++i) {
        const PendingVertex &v = vertices_[i];
        const auto since = [&](const PendingVertex::Before &before) {
            return before.beta > 0
                       ? RouletteRecord::Segment{(L - before.L).Average() / before.beta, cost_ - before.cost}
                       : RouletteRecord::Segment{};
        };
        const RouletteRecord record{v.p, v.kind, since(v.here), since(v.onwards)};
        if (record.here.IsUsable() && record.onwards.IsUsable()) roulette_->Record(*path_, i, record);
    }
    pendingVertices_ = 0;
    const Float radiance = L.Average();
    if (std::isfinite(radiance * radiance)) roulette_->RecordPath(*path_, {radiance, PathCost::kCamera + cost_});
}

}  // namespace ext
