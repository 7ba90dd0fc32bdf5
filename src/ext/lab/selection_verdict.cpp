#include "ext/lab/selection_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "pbrt/math/statistics.h"

// Statistic of a region: sum of the excess over the sum of the light of its paths, with noise estimated from the
// variation between paths. Vertices are scaled down to kMaxVertex times the mean light of the region's lit paths. The
// light is independent of the draws, so the mean of the excess stays 0, no single path dominates, and sums over
// hundreds of paths are nearly normal.

namespace ext::lab {

namespace {

constexpr double kMaxVertex = 8;
constexpr double kMinEffective = 20;  ///< minimum effective paths for a statement
constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Sums {
    double light = 0, excess = 0, squares = 0, lightSquares = 0, unjudged = 0;
    double Difference() const { return light > 0 ? excess / light : 0; }
    /// The excess has mean 0 without bias, so the sum of its squares estimates the variance of its sum.
    double StandardError() const { return light > 0 ? std::sqrt(squares) / light : kInfinity; }
    /// Number of paths of equal light with the same noise.
    double Paths() const { return lightSquares > 0 ? light * light / lightSquares : 0; }
    double Unjudged() const { return light > 0 ? unjudged / light : 0; }
    Sums &operator+=(const Sums &o) {
        light += o.light;
        excess += o.excess;
        squares += o.squares;
        lightSquares += o.lightSquares;
        unjudged += o.unjudged;
        return *this;
    }
};

Sums SumUp(std::span<const VertexFinding> region) {
    double light = 0;
    size_t paths = 0;
    for (const VertexFinding &v : region) {
        light += static_cast<double>(v.light);
        paths += v.endsPath;
    }
    const double most = kMaxVertex * light / static_cast<double>(std::max<size_t>(paths, 1));
    Sums sums;
    double pathLight = 0, pathExcess = 0;
    for (const VertexFinding &v : region) {
        const double weight = static_cast<double>(v.light) > most ? most / static_cast<double>(v.light) : 1;
        pathLight += weight * static_cast<double>(v.light);
        pathExcess += weight * static_cast<double>(v.excess);
        sums.unjudged += weight * static_cast<double>(v.unjudged);
        if (!v.endsPath) continue;
        sums.light += pathLight;
        sums.excess += pathExcess;
        sums.squares += pathExcess * pathExcess;
        sums.lightSquares += pathLight * pathLight;
        pathLight = pathExcess = 0;
    }
    return sums;
}

std::string Percent(double share) {
    return std::abs(share) < 0.995 ? fmt::format("{:.2g} %", 100 * share) : fmt::format("{:.0f} %", 100 * share);
}

}  // namespace

double EffectivePaths(std::span<const VertexFinding> region) { return SumUp(region).Paths(); }

SelectionReport JudgeSelection(std::span<const std::vector<VertexFinding>> regions, const BiasSettings &settings) {
    SelectionReport report;
    Sums whole;
    std::vector<Sums> sums;
    size_t withLight = 0;
    for (const auto &region : regions) {
        report.vertices +=
            std::count_if(region.begin(), region.end(), [](const VertexFinding &v) { return v.light > 0; });
        sums.push_back(SumUp(region));
        whole += sums.back();
        withLight += sums.back().light > 0;
    }
    report.difference = whole.Difference();
    report.standardError = whole.StandardError();
    report.unjudged = whole.Unjudged();
    if (withLight == 0) {
        report.text = "no vertex receives light";
        return report;
    }
    const double level = SidakLevel(settings.level, withLight + 1);
    // Critical value of Student's t times the standard error, for a two-sided level p.
    auto deviates = [&](const Sums &s, double p) {
        return s.Paths() >= kMinEffective ? StudentCritical(p, s.Paths() - 1) * s.StandardError() : kInfinity;
    };
    auto visible = [&](const Sums &s, double allowance) {
        return std::max(allowance, deviates(s, level) + deviates(s, 0.2)) + s.Unjudged();
    };
    auto isBiased = [&](const Sums &s, double allowance) {
        return std::abs(s.Difference()) > std::max(allowance, deviates(s, level));
    };
    report.visibleImage = visible(whole, settings.allowanceImage);
    std::vector<double> ofRegions;
    bool biased = isBiased(whole, settings.allowanceImage);
    if (biased) report.worstDifference = report.difference;
    for (size_t r = 0; r < sums.size(); ++r) {
        if (!(sums[r].light > 0)) continue;
        ofRegions.push_back(visible(sums[r], settings.allowanceRegion));
        if (!isBiased(sums[r], settings.allowanceRegion)) continue;
        biased = true;
        if (std::abs(sums[r].Difference()) > std::abs(report.worstDifference)) {
            report.worstRegion = static_cast<int>(r);
            report.worstDifference = sums[r].Difference();
        }
    }
    const auto middle = ofRegions.begin() + ((ofRegions.size() - 1) / 2);
    std::nth_element(ofRegions.begin(), middle, ofRegions.end());
    report.visibleSixteenth = *middle;
    report.verdict = biased                                         ? BiasVerdict::Biased
                     : report.visibleSixteenth <= settings.interest ? BiasVerdict::Clean
                                                                    : BiasVerdict::Unknown;
    report.text = fmt::format("at {} path vertices light selection deviates by {:+.2g} +- {:.1g} %", report.vertices,
                              100 * report.difference, 100 * report.standardError);
    if (biased && report.worstRegion >= 0)
        report.text += fmt::format(", by {:+.2g} % in row {}, column {} of {} x {} regions",
                                   100 * report.worstDifference, report.worstRegion / kSelectionSide + 1,
                                   report.worstRegion % kSelectionSide + 1, kSelectionSide, kSelectionSide);
    if (std::isfinite(report.visibleSixteenth))
        report.text += fmt::format("; detectable: {} in the whole image, {} in a sixteenth",
                                   Percent(report.visibleImage), Percent(report.visibleSixteenth));
    else report.text += "; too few of them receive light for a detection limit";
    return report;
}

Json ToJson(const SelectionReport &r) {
    auto finite = [](double v) { return std::isfinite(v) ? Json(v) : Json(); };
    return {{"verdict", BiasVerdictName(r.verdict)},
            {"vertices", r.vertices},
            {"draws", r.draws},
            {"difference", r.difference},
            {"standardError", finite(r.standardError)},
            {"visibleImage", finite(r.visibleImage)},
            {"visibleSixteenth", finite(r.visibleSixteenth)},
            {"unjudged", r.unjudged},
            {"worstRegion", r.worstRegion},
            {"worstDifference", r.worstDifference},
            {"text", r.text}};
}

SelectionReport SelectionFromJson(const Json &json) {
    auto number = [&](const char *name) { return json.at(name).is_null() ? kInfinity : json.at(name).get<double>(); };
    SelectionReport r;
    for (BiasVerdict v : {BiasVerdict::Clean, BiasVerdict::Biased, BiasVerdict::Unknown})
        if (json.at("verdict") == BiasVerdictName(v)) r.verdict = v;
    r.vertices = json.at("vertices");
    r.draws = json.at("draws");
    r.difference = json.at("difference");
    r.standardError = number("standardError");
    r.visibleImage = number("visibleImage");
    r.visibleSixteenth = number("visibleSixteenth");
    r.unjudged = json.at("unjudged");
    r.worstRegion = json.at("worstRegion");
    r.worstDifference = json.at("worstDifference");
    r.text = json.at("text");
    return r;
}

void AddSelection(const SelectionReport &selection, BiasReport *report) {
    const std::string atVertices = " Vertex by vertex: " + selection.text + ".";
    const bool picturesShowNothing = !report->worst.biased;
    if (selection.verdict == BiasVerdict::Clean && report->verdict == BiasVerdict::Unknown && picturesShowNothing) {
        // This text replaces "Too few data": the vertices are sufficient.
        report->verdict = BiasVerdict::Clean;
        auto size = [](double v) { return std::isfinite(v) ? Percent(v) : std::string("none"); };
        report->text = fmt::format(
            "No bias detected, and the check at path vertices would have detected one; smallest detectable by the "
            "pictures alone: {} in the whole image, {} in regions of 1/{} of it.",
            size(report->visibleImage), size(report->visibleSixteenth), report->sixteenthRegions);
    }
    if (selection.verdict == BiasVerdict::Biased && report->verdict != BiasVerdict::Biased) {
        report->verdict = BiasVerdict::Biased;
        report->text = "The pictures alone do not show this bias.";
    }
    report->text += atVertices;
}

}  // namespace ext::lab
