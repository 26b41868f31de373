// SPDX-License-Identifier: GPL-3.0-or-later
#include "provenance/events.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <type_traits>
#include <utility>

#include "provenance/errors.hpp"
#include "provenance/json_text.hpp"

namespace shearcell {

using nlohmann::json;

namespace events {
namespace {

/// A member that layout 2 added. body() adds it with the value null to payloads of layout 1.
struct Added {
  std::string_view type;
  const char* member;
};

constexpr std::array<Added, 4> kAdded = {{{RunStarted::kType, "process"},
                                          {RunStarted::kType, "parent_checkpoint"},
                                          {RunResumed::kType, "process"},
                                          {RunCompleted::kType, "target_cycles"}}};

template <class T>
constexpr bool has_fields = requires(T& value) {
  T::fields(value, [](const char*, auto&, bool = false) {});
};
template <class T>
constexpr bool is_optional = requires(T& value) {
  value.has_value();
};

template <class T>
void read_fields(const json& from, T& value);

/// Throws json::exception when a required value is missing or has another type.
template <class T>
void read(const json& from, const char* key, T& value) {
  if constexpr (std::is_same_v<T, std::uint64_t>) {
    value = count_at(from, key);
  } else if constexpr (has_fields<T>) {
    read_fields(from.at(key), value);
  } else if constexpr (is_optional<T>) {
    if (!from.at(key).is_null()) read(from, key, value.emplace());
  } else {
    from.at(key).get_to(value);
  }
}

template <class T>
void read_fields(const json& from, T& value) {
  T::fields(value, [&from](const char* name, auto& v, bool if_stated = false) {
    if (!if_stated || from.contains(name)) read(from, name, v);
  });
}

template <class T>
json written(const T& value) {
  if constexpr (has_fields<T>) {
    json inner;
    T::fields(value, [&inner](const char* name, const auto& v, bool if_stated = false) {
      json given = written(v);
      if (!if_stated || !given.empty()) inner[name] = std::move(given);
    });
    return inner;
  } else if constexpr (is_optional<T>) {
    return value ? json(*value) : json();
  } else {
    return value;
  }
}

template <class... E>
Any decode_any(const Event& event, const json& body, const std::variant<Other, E...>*) {
  Any result;
  ((event.type == E::kType && (read_fields(body, result.emplace<E>()), true)) || ...);
  return result;
}

}  // namespace

Any decode(const Event& event) {
  const json body = event.body();
  try {
    return decode_any(event, body, static_cast<const Any*>(nullptr));
  } catch (const json::exception& problem) {
    throw damaged_payload(event, problem);
  }
}

NewEvent encode(const Any& event) {
  return std::visit(
      [](const auto& e) {
        return NewEvent{std::string(e.kType), written(e)};
      },
      event);
}

std::uint64_t newest_schema(std::string_view type) {
  return std::ranges::count(kAdded, type, &Added::type) > 0 ? 2 : 1;
}

}  // namespace events

json Event::body() const {
  json body = parse_json(payload);
  if (!body.is_object()) {
    throw StoreDamaged(fmt::format(
        "event {} ({} of {}): its payload is not a JSON object or is nested too deeply; run "
        "`verify`",
        seq, type, stream));
  }
  const std::uint64_t newest = events::newest_schema(type);
  if (schema > newest) {
    throw StoreDamaged(
        fmt::format("event {} ({}): its payload has layout {}, and this program knows layouts up "
                    "to {}; use the newer shearcell that wrote it",
                    seq, type, schema, newest));
  }
  for (const events::Added& added : events::kAdded) {
    if (added.type == type && schema < newest) body[added.member] = nullptr;
  }
  return body;
}

}  // namespace shearcell
