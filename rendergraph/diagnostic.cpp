#include "rendergraph/diagnostic.hpp"

namespace tyndall::rg {
namespace {

std::string place(const std::source_location& where) {
    std::string_view file = where.file_name();
    if (const std::size_t slash = file.rfind('/'); slash != std::string_view::npos) {
        file.remove_prefix(slash + 1);
    }
    return std::string(file) + ":" + std::to_string(where.line());
}

} // namespace

std::string_view name_of(DiagnosticCode code) {
    switch (code) {
    case DiagnosticCode::foreign_handle: return "foreign handle";
    case DiagnosticCode::read_of_unwritten: return "read of something never written";
    case DiagnosticCode::two_writers: return "two writers of one version";
    case DiagnosticCode::host_too_early: return "host pass after a device pass";
    case DiagnosticCode::cycle: return "cycle";
    case DiagnosticCode::access_not_possible: return "access not possible";
    case DiagnosticCode::queue_cannot: return "queue cannot do this";
    case DiagnosticCode::attachment_mismatch: return "attachments differ";
    case DiagnosticCode::range_outside: return "range outside the resource";
    case DiagnosticCode::import_incomplete: return "import incomplete";
    case DiagnosticCode::duplicate_name: return "duplicate name";
    case DiagnosticCode::empty_pass: return "empty pass";
    case DiagnosticCode::conflicting_access: return "conflicting access";
    case DiagnosticCode::history_misuse: return "history misused";
    case DiagnosticCode::bad_description: return "bad description";
    case DiagnosticCode::no_queue: return "no queue";
    case DiagnosticCode::unknown_injection_point: return "unknown injection point";
    case DiagnosticCode::plan_not_repeated: return "plan not repeated";
    case DiagnosticCode::bad_file: return "file";
    }
    return "";
}

std::string to_text(const Diagnostic& diagnostic) {
    const bool has_place = diagnostic.where.line() != 0;
    std::string text = (has_place ? place(diagnostic.where) + ": " : "") + std::string(name_of(diagnostic.code)) +
                       ": " + diagnostic.message;
    const bool same = diagnostic.where.line() == diagnostic.other_where.line() &&
                      std::string_view(diagnostic.where.file_name()) == diagnostic.other_where.file_name();
    if (!same) {
        text += " (see " + place(diagnostic.other_where) + ")";
    }
    return text;
}

std::string to_text(const Diagnostics& diagnostics) {
    std::string text;
    for (const Diagnostic& diagnostic : diagnostics) {
        text += to_text(diagnostic) + "\n";
    }
    return text;
}

} // namespace tyndall::rg
