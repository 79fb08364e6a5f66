// SPDX-License-Identifier: Apache-2.0
// The project's JSON Schemas, and a validator for them that is compiled once.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace tagsmith::detail::test {

// docs/schemas/NAME.schema.json.
nlohmann::json schema_json(const std::string& name);

// Judges documents by a schema (draft 7).
class SchemaJudge {
 public:
  explicit SchemaJudge(const nlohmann::json& schema);
  ~SchemaJudge();

  bool accepts(const nlohmann::json& document);

  // What is wrong with a document, a line for each objection; empty when it is accepted.
  std::string objections(const nlohmann::json& document);

 private:
  struct Schema;
  std::unique_ptr<Schema> schema_;
};

// Where the schema does not describe a key that it allows.
std::vector<std::string> undescribed_keys(const nlohmann::json& schema);

}  // namespace tagsmith::detail::test
