#include "samples/tyndall/precision_choice.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <map>
#include <optional>

#include "samples/precision/choice.hpp"

namespace tyndall::samples {
namespace {

template <typename T>
using Expected = tl::expected<T, std::string>;

/// Of the bench's scene, the last frame against all of physics.
std::vector<PrecisionRow> judged_rows(const Bench& bench, std::span<const PrecisionRow> rows) {
    std::vector<PrecisionRow> judged;
    std::copy_if(rows.begin(), rows.end(), std::back_inserter(judged), [&](const PrecisionRow& row) {
        return row.scene == bench.scene.name && row.frame == bench.frames && row.physics == full_physics;
    });
    return judged;
}

std::vector<Measured> measured(std::span<const PrecisionRow> rows) {
    std::vector<Measured> all;
    for (const PrecisionRow& row : rows) {
        all.push_back({row.error.relative_l2, row.fog_ms});
    }
    return all;
}

std::string factor(double value) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.3g", value);
    return text.data();
}

/// Nothing is as exact in less time, if the cheapest that is as exact takes as long.
std::string standing(std::span<const Measured> all, std::span<const std::string> names, std::size_t own) {
    const auto describe = [&](std::size_t i) {
        return names[i] + ": " + percent(all[i].error) + " in " + milliseconds(all[i].time_ms);
    };
    const std::size_t rival = *cheapest_within(all, all[own].error);
    const std::string text = "the scene's own configuration, " + describe(own) + ", ";
    if (all[rival].time_ms >= all[own].time_ms) {
        return text + "is on the front\n";
    }
    return text + "misses the front: as exact in " + factor(all[rival].time_ms / all[own].time_ms) +
           " of its time is " + describe(rival) + "\n";
}

/// A bound of error or of time. The bounded of the two is `bounded`, and the least of the other is chosen.
struct Wish {
    std::string text;
    double bound = 0.0;
    double Measured::*bounded = nullptr;
    double Measured::*least = nullptr;
    std::optional<std::size_t> (*choose)(std::span<const Measured>, double) = nullptr;
};

/// Among those of which `other` is less than the choice's, the one that comes nearest to the bound.
std::optional<std::size_t> runner_up(std::span<const Measured> all, std::size_t choice, const Wish& wish) {
    std::optional<std::size_t> best;
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (all[i].*wish.least < all[choice].*wish.least &&
            (!best || all[i].*wish.bounded < all[*best].*wish.bounded)) {
            best = i;
        }
    }
    return best;
}

std::string why(std::span<const PrecisionRow> rows, std::span<const Measured> all, std::size_t choice,
                const Wish& wish) {
    const auto within =
        std::count_if(all.begin(), all.end(), [&](const Measured& one) { return one.*wish.bounded <= wish.bound; });
    std::string text = "  because " + std::to_string(within) + " of " + std::to_string(all.size()) +
                       " measured are within that bound and none of them does better";
    if (const auto second = runner_up(all, choice, wish)) {
        text += "; of those that would, the nearest is " + to_text(rows[*second]);
    }
    return text + "\n";
}

/// Runs the choice again; its row, with times as the others'.
Expected<PrecisionRow> run_again(Bench& bench, const PrecisionConfiguration& configuration) {
    Expected<Measurement> again = measure(bench, configuration);
    if (!again) {
        return tl::unexpected(again.error());
    }
    settle_times(bench, again->rows);
    return judged_rows(bench, again->rows).front();
}

Expected<std::string> fulfil(const Wish& wish, Bench& bench, std::vector<PrecisionRow> rows) {
    std::string text = bench.scene.name + ", " + wish.text + ": ";
    std::vector<Measured> all = measured(rows);
    while (const std::optional<std::size_t> choice = wish.choose(all, wish.bound)) {
        const Expected<PrecisionRow> again = run_again(bench, rows[*choice].configuration);
        if (!again) {
            return tl::unexpected(again.error());
        }
        const Measured found = measured({&*again, 1}).front();
        text += to_text(rows[*choice]) + "; run again: " + percent(found.error) + " in " + milliseconds(found.time_ms);
        if (found.*wish.bounded <= wish.bound) {
            return text + "\n" + why(rows, all, *choice, wish);
        }
        text += ", which is beyond the bound; the next: ";
        rows[*choice] = *again;
        all[*choice] = found;
    }
    const auto nearest = static_cast<std::size_t>(
        std::min_element(all.begin(), all.end(),
                         [&](const Measured& a, const Measured& b) { return a.*wish.bounded < b.*wish.bounded; }) -
        all.begin());
    return text + "unreachable by what was measured; nearest is " + to_text(rows[nearest]) + ", " +
           factor(all[nearest].*wish.bounded / wish.bound) + " times the bound\n";
}

} // namespace

Expected<std::string> choose_and_run(const PrecisionArguments& arguments, Bench& bench,
                                     std::span<const PrecisionRow> rows) {
    std::vector<Wish> wishes;
    if (arguments.error) {
        wishes.push_back({"the cheapest within " + percent(*arguments.error), *arguments.error, &Measured::error,
                          &Measured::time_ms, cheapest_within});
    }
    if (arguments.budget_ms) {
        wishes.push_back({"the most exact within " + milliseconds(*arguments.budget_ms), *arguments.budget_ms,
                          &Measured::time_ms, &Measured::error, most_exact_within});
    }
    std::string text;
    for (const Wish& wish : wishes) {
        Expected<std::string> line = fulfil(wish, bench, judged_rows(bench, rows));
        if (!line) {
            return line;
        }
        text += *line;
    }
    return text;
}

std::string own_against_front(const Bench& bench, std::span<const PrecisionRow> rows) {
    const std::vector<PrecisionRow> judged = judged_rows(bench, rows);
    const auto own = std::find_if(judged.begin(), judged.end(), [](const PrecisionRow& row) { return row.is_own; });
    if (judged.size() < 2 || own == judged.end()) {
        return {};
    }
    std::vector<std::string> names;
    for (const PrecisionRow& row : judged) {
        names.push_back(to_text(row.configuration));
    }
    return bench.scene.name + ", " + standing(measured(judged), names, static_cast<std::size_t>(own - judged.begin()));
}

std::string own_against_front_of_all(std::uint32_t last_frame, std::span<const PrecisionRow> rows) {
    std::map<std::string, std::vector<const PrecisionRow*>> scenes;
    for (const PrecisionRow& row : rows) {
        if (row.frame == last_frame && row.physics == full_physics) {
            scenes[row.scene].push_back(&row);
        }
    }
    if (scenes.size() < 2) {
        return {};
    }
    std::vector<Measured> all;
    std::vector<std::string> names;
    const auto add = [&](const std::string& name, const auto& is_wanted) {
        Measured sum;
        for (const auto& [scene, measured_there] : scenes) {
            const auto row = std::find_if(measured_there.begin(), measured_there.end(),
                                          [&](const PrecisionRow* one) { return is_wanted(*one, measured_there); });
            if (row == measured_there.end()) {
                return;
            }
            sum.error += (*row)->error.relative_l2 * (*row)->error.relative_l2 / static_cast<double>(scenes.size());
            sum.time_ms += (*row)->fog_ms;
        }
        all.push_back({std::sqrt(sum.error), sum.time_ms});
        names.push_back(name);
    };
    add("own", [](const PrecisionRow& row, const auto&) { return row.is_own; });
    if (all.empty()) {
        return {};
    }
    for (const PrecisionRow* model : scenes.begin()->second) {
        add(to_text(model->configuration), [&](const PrecisionRow& row, const auto& measured_there) {
            PrecisionConfiguration wanted = model->configuration;
            const bool varies = std::any_of(measured_there.begin(), measured_there.end(), [&](const PrecisionRow* one) {
                return one->configuration.visibility != measured_there.front()->configuration.visibility;
            });
            wanted.visibility = varies ? wanted.visibility : row.configuration.visibility;
            return row.configuration == wanted;
        });
    }
    return all.size() < 2 ? "" : "all scenes together, " + standing(all, names, 0);
}

} // namespace tyndall::samples
