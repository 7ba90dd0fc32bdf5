#include "pbrt/integrators/guided_bounces.h"

namespace pbrt {

void GuidedBounces::FindTarget(Float distance) {
    GuideRecord &record = bounces_[open_ - 1].record;
    record.target = record.p + record.wi * distance;
    seeksTarget_ = false;
}

void GuidedBounces::Reached(const PathVertex &vertex) {
    if (!seeksTarget_) return;
    way_ += Distance(at_, vertex.point.p);
    at_ = vertex.point.p;
    // Mirrors show what is behind them as far away as the way there is long.
    const BxdfFlags flags = vertex.bsdf.Flags();
    if (IsNonSpecular(flags) || !IsSpecular(flags)) FindTarget(way_);
}

void GuidedBounces::ReachedInMedium(const Point3 &p) {
    if (seeksTarget_) FindTarget(way_ + Distance(at_, p));
}

void GuidedBounces::Begin(const PathVertex &vertex, const SampledSpectrum &beta) {
    const auto &[point, bsdf] = vertex;
    share_ = 0;
    isGuided_ = false;
    if (!guide_.LearnsDirections()) return;
    const bool isRecorded = places_.next + open_ < places_.end;
    if (!isRecorded && !guide_.Cells().Guide()) return;
    beta_ = beta.Average();
    const Float worth = Sqr(beta_ * worth_);
    if (!(isRecorded || guide_.Cells().MayGuide(worth)) || !PathGuide::Guides(bsdf)) return;
    isGuided_ = true;
    isGlossy_ = Has(bsdf.Flags(), BxdfFlags::Glossy);
    bothSides_ = IsTransmissive(bsdf.Flags());
    const Vector3 n(point.shading.n);
    normal_ = Dot(point.wo, n) < 0 ? -n : n;
    Float share = 0;
    const PerGuideTarget *const radiances = guide_.Cells().At(point.p, isGlossy_, worth, &share);
    if (!radiances) return;
    directions_.Prepare(guide_.Cells().Targets(), *radiances, point.p, normal_, bothSides_);
    if (directions_.IsUsable()) share_ = share;
}

Float GuidedBounces::Pdf(const PathVertex &vertex, const Vector3 &wi) const {
    const Float pdf = vertex.bsdf.Pdf(vertex.point.wo, wi);
    return share_ > 0 ? (1 - share_) * pdf + share_ * directions_.Pdf(wi) : pdf;
}

std::optional<BsdfSample> GuidedBounces::Sample(const PathVertex &vertex, Float uc, const Point2 &u) const {
    const auto &[point, bsdf] = vertex;
    if (!(share_ > 0)) return bsdf.Sample(point.wo, uc, u);
    std::optional<BsdfSample> sample;
    if (uc < share_) {
        const Vector3 wi = directions_.Sample(u);
        const Float guidePdf = directions_.Pdf(wi);
        const SampledSpectrum f = bsdf.FOfSamples(point.wo, wi);
        if (!f || !(guidePdf > 0)) return sample;
        const bool transmits = (Dot(wi, point.shading.n) < 0) != (Dot(point.wo, point.shading.n) < 0);
        const BxdfFlags side = transmits ? BxdfFlags::Transmission : BxdfFlags::Reflection;
        sample = {.f = f,
                  .wi = wi,
                  .pdf = (1 - share_) * bsdf.Pdf(point.wo, wi) + share_ * guidePdf,
                  .flags = side | (isGlossy_ ? BxdfFlags::Glossy : BxdfFlags::Diffuse)};
        return sample;
    }
    sample = bsdf.Sample(point.wo, std::min((uc - share_) / (1 - share_), OneMinusEpsilon), u);
    if (!sample) return sample;
    if (IsSpecular(sample->flags)) {
        sample->pdf *= 1 - share_;
        return sample;
    }
    // One sample of two techniques by the balance heuristic. Its weights use Bsdf::Pdf for both, which need not be the
    // density that the BSDF sampled with: they add up to one all the same.
    const Float bsdfPdf = sample->pdfIsProportional ? bsdf.Pdf(point.wo, sample->wi) : sample->pdf;
    const Float guidePdf = directions_.Pdf(sample->wi);
    const Float pdf = (1 - share_) * bsdfPdf + share_ * guidePdf;
    if (!(pdf > 0)) {
        sample->pdf *= 1 - share_;
        return sample;
    }
    sample->f *= bsdfPdf / sample->pdf;
    sample->pdf = pdf;
    sample->pdfIsProportional = false;
    return sample;
}

void GuidedBounces::Left(const PathVertex &vertex, const BsdfSample &sample, Float pdf, const SampledSpectrum &L,
                         const SampledSpectrum &beta) {
    if (seeksTarget_) FindTarget(way_);
    if (!isGuided_ || places_.next + open_ >= places_.end || open_ == kMaxOpen) return;
    seeksTarget_ = true;
    way_ = 0;
    at_ = vertex.point.p;
    OpenBounce &open = bounces_[open_++];
    open.L = L;
    open.beta = beta;
    open.record = {.p = vertex.point.p,
                   .normal = normal_,
                   .wi = sample.wi,
                   .pdf = pdf,
                   .bsdfPdf = share_ > 0 ? vertex.bsdf.Pdf(vertex.point.wo, sample.wi) : pdf,
                   .beta = beta_,
                   .bothSides = bothSides_,
                   .isGlossy = isGlossy_};
}

Float GuidedBounces::Survival(const PathVertex &vertex, Float beta) {
    if (!IsNonSpecular(vertex.bsdf.Flags())) {
        cell_ = {};
        return 0;
    }
    return SurvivalIn(roulette_->At(vertex.point.p, PathRoulette::KindOf(vertex)), beta);
}

Float GuidedBounces::SurvivalInMedium(const Point3 &p, Float beta) {
    return SurvivalIn(roulette_->At(p, PathRoulette::kInMedium), beta);
}

Float GuidedBounces::SurvivalIn(const PathRoulette::Cell &cell, Float beta) {
    cell_ = cell;
    return PathRoulette::Survival(cell.here, beta * worth_, std::min(PathRoulette::kMinSurvival / onwards_, Float(1)));
}

Float GuidedBounces::SurvivalOnwards(Float beta) {
    const Float survival = PathRoulette::Survival(cell_.onwards, beta * worth_);
    onwards_ = survival > 0 ? survival : 1;
    return onwards_;
}

void GuidedBounces::GoesOn(const SampledSpectrum &beta, const SampledSpectrum &L) {
    if (isOpen_) {
        OpenVertex &v = vertices_[openVertices_ - 1];
        v.onwards = {L, beta.Average(), cost_};
        isOpen_ = false;
    }
    cost_ += PathCost::kBounce;
}

void GuidedBounces::OpenAt(const Point3 &p, uint32_t kind, const SampledSpectrum &beta, const SampledSpectrum &L) {
    const OpenVertex::Part here{L, beta.Average(), cost_};
    cost_ += PathCost::kLight;
    isOpen_ = roulette_ && path_ && openVertices_ < vertices_.size() && here.beta > 0;
    if (isOpen_) vertices_[openVertices_++] = {p, kind, here, {}};
}

void GuidedBounces::Open(const PathVertex &vertex, const SampledSpectrum &beta, const SampledSpectrum &L) {
    OpenAt(vertex.point.p, PathRoulette::KindOf(vertex), beta, L);
}

void GuidedBounces::OpenInMedium(const Point3 &p, const SampledSpectrum &beta, const SampledSpectrum &L) {
    OpenAt(p, PathRoulette::kInMedium, beta, L);
}

void GuidedBounces::End(const SampledSpectrum &L) {
    if (seeksTarget_) FindTarget(guide_.Beyond());
    for (size_t i = 0; i < open_; ++i) {
        OpenBounce &open = bounces_[i];
        const SampledSpectrum added = L - open.L;
        open.record.found = added.Average() / open.record.beta;
        Float radiance = 0;
        for (int k = 0; k < SpectrumSamples; ++k)
            if (open.beta[k] > 0) radiance += added[k] / open.beta[k];
        open.record.radiance = radiance / SpectrumSamples;
        if (open.record.pdf > 0 && open.record.radiance >= 0 && open.record.found >= 0 &&
            std::isfinite(open.record.radiance * open.record.radiance / open.record.pdf) &&
            std::isfinite(open.record.found * open.record.found * open.record.pdf))
            guide_.Record(places_, open.record);
    }
    open_ = 0;
    if (!roulette_ || !path_) return;
    const size_t first = *path_ * roulette_->Vertices();
    for (size_t i = 0; i < std::min(openVertices_, roulette_->Vertices()); ++i) {
        const OpenVertex &v = vertices_[i];
        const auto since = [&](const OpenVertex::Part &part) {
            return part.beta > 0 ? RouletteRecord::Part{(L - part.L).Average() / part.beta, cost_ - part.cost}
                                 : RouletteRecord::Part{};
        };
        const RouletteRecord record{v.p, v.kind, since(v.here), since(v.onwards)};
        if (record.here.IsUsable() && record.onwards.IsUsable()) roulette_->Record(first + i, record);
    }
    openVertices_ = 0;
    const Float found = L.Average();
    if (std::isfinite(found * found)) roulette_->RecordPath(*path_, {found, PathCost::kCamera + cost_});
}

}  // namespace pbrt
