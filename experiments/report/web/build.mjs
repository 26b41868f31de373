// SPDX-License-Identifier: GPL-3.0-or-later
// Bundles the front end into report.js. Writes the licences of the bundled packages into licences.txt, and the names
// and hashes of the packages into packages.json:
//   node build.mjs FOLDER_WITH_NODE_MODULES OUT_FOLDER
import {mkdirSync, readdirSync, readFileSync, writeFileSync} from "node:fs";
import {createRequire} from "node:module";
import {dirname, join, resolve} from "node:path";
import {fileURLToPath} from "node:url";

const [modulesParent, out] = process.argv.slice(2).map((path) => resolve(path));
const here = dirname(fileURLToPath(import.meta.url));
const {build} = createRequire(join(modulesParent, "package.json"))("esbuild");

const result = await build({
  absWorkingDir: modulesParent,
  entryPoints: [join(here, "src/main.js")],
  nodePaths: [join(modulesParent, "node_modules")],
  bundle: true,
  minify: true,
  format: "iife",
  target: "es2021",
  charset: "utf8",
  legalComments: "none",  // licences.txt has the whole licences
  write: false
});

function licenceOf(folder) {
  const file = readdirSync(folder).find((name) => /^(licen[cs]e|copying)/i.test(name));
  if (!file) throw new Error(`${folder} has no licence file`);
  return readFileSync(join(folder, file), "utf8").trim();
}

const packages = Object.keys(JSON.parse(readFileSync(join(here, "package.json"), "utf8")).dependencies);
const locked = JSON.parse(readFileSync(join(modulesParent, "package-lock.json"), "utf8")).packages;
const list = packages.map((name) => {
  const {version, license, integrity} = locked[`node_modules/${name}`];
  const [kind, hash] = integrity.split("-");
  if (kind !== "sha512") throw new Error(`the lock file has no SHA-512 of ${name}`);
  return {name, version, license, sha512: Buffer.from(hash, "base64").toString("hex")};
});
const licences = list.map(({name, version, license}) =>
  `${name} ${version} (${license})\n\n${licenceOf(join(modulesParent, "node_modules", name))}\n`);

const script = result.outputFiles[0].text.trim();
// The script is put into a page without escaping.
if (/<\/script|<!--/i.test(script)) throw new Error("the bundle would end its own script element");
mkdirSync(out, {recursive: true});
writeFileSync(join(out, "report.js"), script);
writeFileSync(join(out, "licences.txt"), licences.join("\n" + "-".repeat(72) + "\n\n"));
writeFileSync(join(out, "packages.json"), JSON.stringify(list, null, 2) + "\n");
