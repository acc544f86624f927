// Lints ../api/openapi.json by the rules of ../api/redocly.yaml; exit 1 with the findings.
import { lint, loadConfig } from '@redocly/openapi-core';
import { fileURLToPath } from 'node:url';

const inApi = (name) => fileURLToPath(new URL(`../api/${name}`, import.meta.url));
const config = await loadConfig({ configPath: inApi('redocly.yaml') });
const findings = await lint({ ref: inApi('openapi.json'), config });
for (const { ruleId, message, location } of findings) {
  console.error(`${location[0]?.pointer ?? ''}: ${message} (${ruleId})`);
}
process.exitCode = findings.length > 0 ? 1 : 0;
