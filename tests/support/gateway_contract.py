"""Holds what the gateway receives and sends against its description, services/cloud-gateway/api/openapi.json."""
import json
import pathlib
import re
from urllib.parse import urlsplit

import jsonschema

DOCUMENT = pathlib.Path(__file__).resolve().parent.parent.parent / "services/cloud-gateway/api/openapi.json"
WITHOUT_BODY = (204, 304)


class Contract:
    def __init__(self):
        self.document = json.loads(DOCUMENT.read_text())
        self.resolver = jsonschema.RefResolver("", self.document)
        self.paths = [(re.compile(re.sub(r"\{\w+\}", "[^/]+", path) + "$"), operations)
                      for path, operations in self.document["paths"].items()]
        # "/scenarios/check" before "/scenarios/{scenario}"
        self.paths.sort(key=lambda row: row[0].pattern.count("[^/]+"))

    def operation(self, method, target):
        path = urlsplit(target).path
        for pattern, operations in self.paths:
            if pattern.match(path) and method.lower() in operations:
                return operations[method.lower()]
        return None

    def fit(self, value, schema, what):
        """Raises an AssertionError that names the part that does not fit."""
        fault = jsonschema.exceptions.best_match(
            jsonschema.Draft202012Validator(schema, resolver=self.resolver).iter_errors(value))
        if fault is not None:
            place = "/".join(str(part) for part in fault.absolute_path)
            raise AssertionError(f"{what}: /{place}: {fault.message[:500]}")

    def check(self, method, target, body, answer):
        what = f"{method} {target} -> {answer.status}"
        operation = self.operation("GET" if method == "HEAD" else method, target)
        if operation is None or answer.status >= 400:
            return self.check_problem(answer, what)
        answers = operation["responses"]
        assert str(answer.status) in answers, f"{what}: this status is not described"
        self.check_answer(answers[str(answer.status)], answer, what)
        if body is not None and "requestBody" in operation:
            described = operation["requestBody"]["content"]["application/json"]["schema"]
            self.fit(json.loads(body), described, f"{what}: the request's body")

    def check_problem(self, answer, what):
        assert answer.headers["Content-Type"] == "application/problem+json", f"{what}: no problem"
        self.fit(answer.json, {"$ref": "#/components/schemas/Problem"}, what)
        assert answer.json["status"] == answer.status, f"{what}: another status in the problem"

    def check_answer(self, described, answer, what):
        content = described.get("content")
        if content is None:
            assert answer.bytes == b"", f"{what}: a body, and none is described"
            return
        media = answer.headers["Content-Type"].split(";")[0]
        assert media in content, f"{what}: {media} is not described"
        if media == "application/json":
            self.fit(answer.json, content[media]["schema"], what)

    def check_live(self, heard):
        """A message of the live stream."""
        self.fit(heard, {"$ref": "#/components/schemas/LiveAnswer"}, "live")
