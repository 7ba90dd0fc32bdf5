#include "ext/guiding/guided_directions.h"

namespace ext {

void GuidedDirections::PrepareDirections(const PathVertex &vertex, const SampledSpectrum &beta) {
    const auto &[point, bsdf] = vertex;
    guidingProbability_ = 0;
    unprepared_ = nullptr;
    isGuided_ = false;
    if (!guide_.EstimatesDirections()) return;
    const bool isRecorded = recorder_ && recorder_->HasPlaceForBounce();
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
    constexpr size_t kPerCacheLine = 64 / sizeof(Float);
    for (size_t k = 0; k < unprepared_->size(); k += kPerCacheLine) __builtin_prefetch(&(*unprepared_)[k]);
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
    if (uc < guidingProbability_) {
        const Vector3 wi = directions_.Sample(u);
        const SampledSpectrum f = bsdf.FOfSamples(point.wo, wi);
        if (!f) return {};
        const Float guidePdf = directions_.Pdf(wi);
        if (!(guidePdf > 0)) return {};
        const bool transmits = (Dot(wi, point.shading.n) < 0) != (Dot(point.wo, point.shading.n) < 0);
        const BxdfFlags side = transmits ? BxdfFlags::Transmission : BxdfFlags::Reflection;
        return BsdfSample{.f = f,
                          .wi = wi,
                          .pdf = (1 - guidingProbability_) * bsdf.Pdf(point.wo, wi) + guidingProbability_ * guidePdf,
                          .flags = side | (isGlossy_ ? BxdfFlags::Glossy : BxdfFlags::Diffuse)};
    }
    std::optional<BsdfSample> sample =
        bsdf.Sample(point.wo, std::min((uc - guidingProbability_) / (1 - guidingProbability_), OneMinusEpsilon), u);
    if (!sample) return sample;
    // One-sample MIS of two techniques with the balance heuristic. The weights use Bsdf::Pdf for both, which may differ
    // from the BSDF's sampling density; they sum to one regardless.
    Float bsdfPdf = 0, pdf = 0;
    if (!IsSpecular(sample->flags)) {
        bsdfPdf = sample->pdfIsProportional ? bsdf.Pdf(point.wo, sample->wi) : sample->pdf;
        pdf = (1 - guidingProbability_) * bsdfPdf + guidingProbability_ * directions_.Pdf(sample->wi);
    }
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
    if (!recorder_) return;
    recorder_->FinishSource();
    if (!isGuided_ || !recorder_->HasPlaceForBounce()) return;
    recorder_->AddBounce({.p = vertex.point.p,
                          .normal = normal_,
                          .wi = sample.wi,
                          .pdf = pdf,
                          .bsdfPdf = guidingProbability_ > 0 ? vertex.bsdf.Pdf(vertex.point.wo, sample.wi) : pdf,
                          .beta = beta_,
                          .bothSides = bothSides_,
                          .isGlossy = isGlossy_},
                         L, beta);
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

}  // namespace ext
