#include "ext/lab/lightlab/lightlab.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "ext/lab/text_output.h"
#include "pbrt/core/files.h"

namespace ext::lab {
namespace {

constexpr const char *kHead = R"(<title>lightlab: all scenes</title>
<style>
:root { color-scheme: light dark; --soft: #5b636e; --line: #d5d9de; --best: #0b6b43; --bad: #a3210f; --link: #0a58a6; }
@media (prefers-color-scheme: dark) {
  :root { --soft: #a1a9b4; --line: #363b42; --best: #7ddaa8; --bad: #ff9d8a; --link: #86bcff; }
}
body { margin: 0 auto; max-width: 1400px; padding: 24px 28px; font: 15px/1.5 system-ui, "DejaVu Sans", sans-serif; }
h1 { margin: 0; font-size: 28px; } p { max-width: 95ch; } a { color: var(--link); }
.soft, small { color: var(--soft); }
.wide { overflow-x: auto; }
table { border-collapse: collapse; margin: 20px 0; }
th, td { padding: 8px 16px 8px 0; text-align: left; vertical-align: middle; border-bottom: 1px solid var(--line); }
th { font-size: 13px; color: var(--soft); font-weight: 600; vertical-align: bottom; }
td.number, th.number { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
td.winner { color: var(--best); font-weight: 600; } td.biased { color: var(--bad); }
td small { display: block; } tfoot td { border-bottom: 0; }
img { display: block; width: 150px; border-radius: 3px; }
</style>
</head>
<body>
)";

struct Cell {
    double error = 0;
    bool wins = false;
    std::string biasVerdict, speedUp;          ///< as in results.json; no speed-up: empty
    std::optional<double> standardError = {};  ///< empty: one seed

    /// The standard error in this format; empty if unknown.
    std::string Spread(const char *format) const {
        return standardError ? fmt::format(fmt::runtime(format), *standardError) : "";
    }
};

class Grid {
  public:
    explicit Grid(const std::vector<SceneOutcome> &outcomes) {
        for (const SceneOutcome &o : outcomes) {
            std::map<std::string, Cell> &row = rows_.emplace_back();
            if (o.results.is_null()) continue;
            const Json &winner = o.results.at("conclusion").at("winner");
            for (const Json &s : o.results.at("samplers")) {
                const std::string label = s.at("label");
                if (std::ranges::count(labels_, label) == 0) labels_.push_back(label);
                const Json &summary = s.at("summary"), &error = summary.at("metrics").at("relL2");
                const Json &speedUp = summary.at("speedUp");
                row[label] = {error.at("mean"), winner == label, summary.at("bias").at("verdict"),
                              speedUp.is_number() ? speedUp.dump() : ""};
                if (s.at("runs").size() > 1) row[label].standardError = error.at("standardError");
            }
        }
    }
    const std::vector<std::string> &Labels() const { return labels_; }
    const Cell *At(size_t scene, const std::string &label) const {
        const auto found = rows_[scene].find(label);
        return found != rows_[scene].end() ? &found->second : nullptr;
    }
    /// Geometric mean of the sampler's error over the first sampler's, over the scenes that have both; else `none`.
    std::string RatioText(const std::string &label, const char *none) const {
        double sum = 0;
        int count = 0;
        for (size_t i = 0; i < rows_.size(); ++i) {
            const Cell *mine = At(i, label), *first = At(i, labels_[0]);
            if (!mine || !first || !(mine->error > 0) || !(first->error > 0)) continue;
            sum += std::log(mine->error / first->error);
            ++count;
        }
        return count ? fmt::format("{:.3g}", std::exp(sum / count)) : none;
    }

  private:
    std::vector<std::string> labels_;
    std::vector<std::map<std::string, Cell>> rows_;
};

std::string Csv(const std::vector<SceneOutcome> &outcomes) {
    const Grid grid(outcomes);
    std::string text = "scene,sampler,relL2,relL2StandardError,wins,biasVerdict,speedUp,results\n";
    for (size_t i = 0; i < outcomes.size(); ++i)
        for (const std::string &label : grid.Labels())
            if (const Cell *c = grid.At(i, label))
                text += fmt::format("{},{},{:.9g},{},{},{},{},{}\n", Quoted(outcomes[i].folder), Quoted(label),
                                    c->error, c->Spread("{:.9g}"), int(c->wins), c->biasVerdict, c->speedUp,
                                    Quoted(outcomes[i].folder + "/results.json"));
    return text;
}

Json ScenesJson(const std::vector<SceneOutcome> &outcomes) {
    Json json = {{"schema", 1}, {"scenes", Json::array()}};
    for (const SceneOutcome &o : outcomes)
        json["scenes"].push_back(
            {{"scene", o.scene},
             {"folder", o.folder},
             {"results", o.results.is_null() ? Json() : Json(o.folder + "/results.json")},
             {"headline", o.results.is_null() ? Json() : Json(o.results.at("conclusion").at("headline"))},
             {"failure", o.failure.empty() ? Json() : Json(o.failure)}});
    return json;
}

std::string Legend(const std::vector<SceneOutcome> &outcomes) {
    const auto compared = std::ranges::find_if(outcomes, [](const SceneOutcome &o) { return !o.results.is_null(); });
    if (compared == outcomes.end()) return "no scene was compared";
    const Json &budget = compared->results.at("budget");
    return fmt::format("relL2 +- standard error, {} for every sampler and seed",
                       compared->results.at("mode") == "time" ? budget.dump() + " s"
                                                              : CountText(budget.get<int>(), "sample") + " per pixel");
}

std::string PageRow(const std::string &folder, const SceneOutcome &o, size_t index, const Grid &grid) {
    const std::string at = EscapeHtml(o.folder), name = EscapeHtml(o.scene);
    if (o.results.is_null())
        return fmt::format("<tr><td></td><td>{}</td><td colspan=\"{}\">{}</td></tr>\n", name, grid.Labels().size() + 1,
                           EscapeHtml(o.failure));
    // Without a report, links to the data folder.
    const bool hasReport = FileExists(fmt::format("{}/{}/report.html", folder, o.folder));
    const std::string link = at + (hasReport ? "/report.html" : "/results.json");
    std::string row = fmt::format(
        "<tr><td><a href=\"{0}\"><img src=\"{1}/{2}\" alt=\"\"></a></td><td><a href=\"{0}\">{3}</a></td>", link, at,
        EscapeHtml(o.results.at("references").at(0).at("picture")), EscapeHtml(o.results.at("sceneName")));
    for (const std::string &label : grid.Labels()) {
        const Cell *cell = grid.At(index, label);
        row += !cell ? std::string("<td class=\"number\">–</td>")
                     : fmt::format("<td class=\"number{}{}\">{:.3g}{}{}</td>", cell->wins ? " winner" : "",
                                   cell->biasVerdict == "biased" ? " biased" : "", cell->error, cell->wins ? " ★" : "",
                                   cell->Spread("<small>± {:.2g}</small>"));
    }
    return row + fmt::format("<td>{}</td></tr>\n", EscapeHtml(o.results.at("conclusion").at("headline")));
}

std::string Page(const std::string &folder, const std::vector<SceneOutcome> &outcomes) {
    const Grid grid(outcomes);
    std::string page = std::string(kPageHead) + kHead;
    page += fmt::format(
        "<h1>{} scenes</h1>\n<p class=\"soft\">{}. ★: the winner, where the conclusion names one. Red: biased. Each "
        "image leads to the scene's report.</p>\n<div class=\"wide\"><table id=\"scenes\">\n<thead><tr><th></th>"
        "<th>scene</th>",
        outcomes.size(), EscapeHtml(Legend(outcomes)));
    for (const std::string &label : grid.Labels()) page += "<th class=\"number\">" + EscapeHtml(label) + "</th>";
    page += "<th>conclusion</th></tr></thead>\n<tbody>\n";
    for (size_t i = 0; i < outcomes.size(); ++i) page += PageRow(folder, outcomes[i], i, grid);
    page += "</tbody>\n";
    if (!grid.Labels().empty()) {
        page += fmt::format("<tfoot><tr><td></td><td>error over that of {}<small>geometric mean</small></td>",
                            EscapeHtml(grid.Labels()[0]));
        for (const std::string &label : grid.Labels())
            page += fmt::format("<td class=\"number\">{}</td>", grid.RatioText(label, "–"));
        page += "<td></td></tr></tfoot>\n";
    }
    return page +
           "</table></div>\n<p class=\"soft\">The same as data: <a href=\"scenes.csv\">scenes.csv</a>, "
           "<a href=\"scenes.json\">scenes.json</a>.</p>\n</body>\n</html>\n";
}

}  // namespace

std::vector<std::string> SceneFolders(const std::vector<std::string> &scenes) {
    std::vector<std::string> folders;
    for (const std::string &scene : scenes) {
        const std::string stem = std::filesystem::path(scene).stem().string();
        std::string name = stem;
        for (int i = 2; std::ranges::count(folders, name) > 0; ++i) name = fmt::format("{}-{}", stem, i);
        folders.push_back(name);
    }
    return folders;
}

std::string ScenesText(const std::vector<SceneOutcome> &outcomes) {
    const Grid grid(outcomes);
    std::vector<std::vector<std::string>> rows = {{"scene"}};
    for (const std::string &label : grid.Labels()) rows[0].push_back(label);
    for (size_t i = 0; i < outcomes.size(); ++i) {
        rows.push_back({outcomes[i].folder});
        for (const std::string &label : grid.Labels()) {
            const Cell *c = grid.At(i, label);
            rows.back().push_back(!c ? "-"
                                     : fmt::format("{:.3g}{}{}{}", c->error, c->Spread(" +- {:.2g}"),
                                                   c->wins ? " *" : "", c->biasVerdict == "biased" ? " biased" : ""));
        }
    }
    if (!grid.Labels().empty()) {
        rows.push_back({"over " + grid.Labels()[0]});
        for (const std::string &label : grid.Labels()) rows.back().push_back(grid.RatioText(label, "-"));
    }
    std::string text = Align(rows);
    text += fmt::format("\n{}. *: the winner. Last row: error over that of the first sampler, geometric mean.\n",
                        Legend(outcomes));
    for (const SceneOutcome &o : outcomes)
        text += o.results.is_null()
                    ? fmt::format("{}: failed. {}\n", o.folder, o.failure)
                    : fmt::format("{}: {}\n", o.folder, o.results.at("conclusion").at("headline").get<std::string>());
    return text;
}

void WriteScenes(const std::string &folder, const std::vector<SceneOutcome> &outcomes) {
    std::filesystem::create_directories(folder);  // exists unless all scenes failed
    WriteFile(folder + "/scenes.csv", Csv(outcomes));
    WriteFile(folder + "/scenes.json", ScenesJson(outcomes).dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
    WriteFile(folder + "/index.html", Page(folder, outcomes));
}

}  // namespace ext::lab
