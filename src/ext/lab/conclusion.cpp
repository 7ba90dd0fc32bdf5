#include "ext/lab/conclusion.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "ext/lab/measures.h"

namespace ext::lab {
namespace {

constexpr size_t kMaxNamed = 4;  ///< samplers named in a headline

/// "0.0123 +- 0.0004".
std::string ErrorText(const Contender &c) {
    const Summary s = Summarize(c.errors);
    return fmt::format("{:.3g}{}", s.mean, s.count > 1 ? fmt::format(" +- {:.2g}", s.standardError) : "");
}

/// At least one name.
std::string Listed(const std::vector<std::string> &names) {
    if (names.size() == 1) return names[0];
    return fmt::format("{} and {}", fmt::join(names.begin(), names.end() - 1, ", "), names.back());
}

/// Labels of the samplers over which the lead in these errors is not significant.
std::vector<std::string> NotBeaten(const Contender &leader, const std::vector<const Contender *> &others,
                                   std::vector<double> Contender::*errors) {
    std::vector<std::string> names;
    for (const Contender *other : others)
        if (!LowerBeyondNoise(leader.*errors, other->*errors, kWinnerLevel / 2)) names.push_back(other->label);
    return names;
}

std::vector<std::string> Objections(const Contender &leader, const std::vector<const Contender *> &others,
                                    const std::vector<Doubt> &doubts, bool equalTime) {
    std::vector<std::string> reasons;
    const bool noiseIsKnown = leader.errors.size() > 1 &&
                              std::ranges::all_of(others, [](const Contender *o) { return o->errors.size() > 1; });
    if (others.empty()) {
        reasons.push_back(fmt::format("There is no other sampler to compare {} with.", leader.label));
    } else if (!noiseIsKnown) {
        reasons.push_back("One seed gives no noise estimate, hence no ranking; use --seeds 3 or more.");
    } else if (const std::vector<std::string> tied = NotBeaten(leader, others, &Contender::errors); !tied.empty()) {
        reasons.push_back(fmt::format(
            "The lead of {} over {} is within the noise of the runs (level {:g} %); use more seeds or time.",
            leader.label, Listed(tied), 100 * kWinnerLevel));
    } else if (leader.firefliesDecide) {
        if (const std::vector<std::string> near = NotBeaten(leader, others, &Contender::trimmedErrors); !near.empty())
            reasons.push_back(fmt::format(
                "A few fireflies decide the error of {}, and in trimmed relL2 its lead over {} is within noise.",
                leader.label, Listed(near)));
    }
    if (leader.bias != BiasVerdict::Clean)
        reasons.push_back(fmt::format("The bias of {} is unknown; use more seeds or time.", leader.label));
    for (const Doubt &d : doubts)
        if (d.sampler.empty() || d.sampler == leader.label) reasons.push_back(d.text);
    if (equalTime && leader.speedUp && *leader.speedUp < 1)
        reasons.push_back(fmt::format(
            "The curves of error against time contradict the final errors: {} came to the same error in {:.3g} "
            "times the time.",
            leader.speedUpAgainst, *leader.speedUp));
    return reasons;
}

std::string WinnerHeadline(const Contender &leader, const Contender &next, bool equalTime) {
    std::string text = fmt::format("{} has the lowest error at equal {}: relL2 {}; next is {} with {}.", leader.label,
                                   equalTime ? "time" : "samples", ErrorText(leader), next.label, ErrorText(next));
    if (leader.speedUp && *leader.speedUp >= 1)
        text +=
            fmt::format(" {} needs {:.3g} times its time for the same error.", leader.speedUpAgainst, *leader.speedUp);
    return text;
}

std::string UndecidedHeadline(const std::vector<const Contender *> &competing) {
    std::vector<std::string> errors;
    for (size_t i = 0; i < std::min(competing.size(), kMaxNamed); ++i)
        errors.push_back(competing[i]->label + " " + ErrorText(*competing[i]));
    const size_t more = competing.size() - errors.size();
    return fmt::format("Undecided. Mean relL2: {}{}.", fmt::join(errors, ", "),
                       more ? fmt::format(" and {} more", more) : "");
}

}  // namespace

Conclusion Conclude(const std::vector<Contender> &contenders, const std::vector<Doubt> &doubts,
                    std::vector<std::string> remarks, bool equalTime) {
    Conclusion out;
    for (const Doubt &d : doubts) out.doubts.push_back(d.text);
    out.remarks = std::move(remarks);

    std::vector<const Contender *> competing;
    for (const Contender &c : contenders)
        if (!c.isOracle && c.bias != BiasVerdict::Biased && !c.errors.empty() &&
            std::isfinite(Summarize(c.errors).mean))
            competing.push_back(&c);
    std::ranges::stable_sort(competing, {}, [](const Contender *c) { return Summarize(c->errors).mean; });
    if (competing.empty()) {
        out.headline = "Undecided: no sampler that may win has a measured error.";
        out.reasons.push_back("Nothing was measured of a sampler that is neither biased nor the oracle.");
    } else {
        const Contender &leader = *competing.front();
        const std::vector<const Contender *> others(competing.begin() + 1, competing.end());
        out.lowest = size_t(&leader - contenders.data());
        out.reasons = Objections(leader, others, doubts, equalTime);
        if (out.reasons.empty()) out.winner = out.lowest;
        out.headline = out.winner ? WinnerHeadline(leader, *others.front(), equalTime) : UndecidedHeadline(competing);
        if (!equalTime && leader.speedUp && *leader.speedUp < 1)
            out.remarks.push_back(fmt::format(
                "At equal time another sampler is better: {} reaches the error of {} in {:.3g} times its time.",
                leader.speedUpAgainst, leader.label, *leader.speedUp));
    }

    std::vector<std::string> biased, unknown, flies;
    for (const Contender &c : contenders) {
        if (c.firefliesDecide) flies.push_back(c.label);
        if (c.isOracle) continue;
        if (c.bias == BiasVerdict::Biased) biased.push_back(c.label);
        const bool isLeader = out.lowest && &c == &contenders[*out.lowest];
        if (c.bias == BiasVerdict::Unknown && !isLeader) unknown.push_back(c.label);
    }
    if (!biased.empty()) out.remarks.push_back(fmt::format("Biased, and therefore not competing: {}.", Listed(biased)));
    if (!unknown.empty()) out.remarks.push_back(fmt::format("Bias unknown: {}.", Listed(unknown)));
    if (!flies.empty())
        out.remarks.push_back(
            fmt::format("A few fireflies decide the relL2 of {}: see the trimmed relL2.", Listed(flies)));
    return out;
}

std::vector<std::string> Conclusion::Sentences() const {
    std::vector<std::string> sentences = {headline};
    sentences.insert(sentences.end(), reasons.begin(), reasons.end());
    for (const std::string &doubt : doubts)
        if (std::ranges::count(reasons, doubt) == 0) sentences.push_back("Doubt: " + doubt);
    for (const std::string &remark : remarks) sentences.push_back("Note: " + remark);
    return sentences;
}

Json ToJson(const Conclusion &conclusion, const std::vector<Contender> &contenders) {
    auto label = [&](const std::optional<size_t> &i) { return i ? Json(contenders[*i].label) : Json(); };
    return {
        {"winner", label(conclusion.winner)}, {"lowestError", label(conclusion.lowest)}, {"level", kWinnerLevel},
        {"headline", conclusion.headline},    {"reasons", conclusion.reasons},           {"doubts", conclusion.doubts},
        {"remarks", conclusion.remarks},      {"sentences", conclusion.Sentences()}};
}

}  // namespace ext::lab
