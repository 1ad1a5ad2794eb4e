// Bundles the page and puts it into one file. Run in the folder that holds node_modules:
//
//     node build.mjs OUTPUT.html|OUTPUT.cpp
//
// The page has placeholders for theme, policy, title, summary and data ({{hydrapod-…}});
// src/report/html.cpp fills them. Its content security policy allows exactly the script and the
// style that are put in here, and the script's worker with its WebAssembly.
import { createHash } from 'node:crypto';
import { readFileSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';
import { withoutOtherShaders } from './shaders.mjs';

const source = join(dirname(fileURLToPath(import.meta.url)), 'src');
const modules = resolve('node_modules');
const esbuild = createRequire(join(modules, '..', 'package.json'))('esbuild');

async function bundle(entry, plugins = []) {
  const result = await esbuild.build({
    entryPoints: [join(source, entry)],
    bundle: true,
    minify: true,
    write: false,
    format: 'iife',
    target: 'es2021',
    charset: 'utf8',
    legalComments: 'none',
    nodePaths: [modules],
    plugins,
    logLevel: 'warning',
  });
  // lines begin only in the texts of shaders, which need no indentation, comments and empty lines; those without
  // a back quote are shader and nothing else, and need no blanks
  return result.outputFiles[0].text
    .replace(/\n[ \t]+/g, '\n')
    .replace(/\n\/\/[^\n]*/g, '')
    .replace(/\n\n+/g, '\n')
    .replace(/(?<=\n)[^\n`$#]+(?=\n)/g, (line) => line.replace(/ *([=(),*;{}]) */g, '$1'));
}

// The worker is a script of its own inside the page's script.
const worker = {
  name: 'core-worker',
  setup(build) {
    build.onResolve({ filter: /^core-worker$/ }, ({ path }) => ({ path, namespace: 'worker' }));
    build.onLoad({ filter: /.*/, namespace: 'worker' }, async () => ({
      contents: await bundle('core/worker.ts'),
      loader: 'text',
    }));
  },
};

const shaders = {
  name: 'shaders',
  setup(build) {
    build.onLoad({ filter: /three\.module\.js$/ }, ({ path }) => ({
      contents: withoutOtherShaders(readFileSync(path, 'utf8')),
    }));
  },
};

// A module of the page, for use here.
async function moduleOf(file) {
  const { code } = await esbuild.transform(readFileSync(join(source, file), 'utf8'), { loader: 'ts', format: 'esm' });
  return import(`data:text/javascript;base64,${Buffer.from(code).toString('base64')}`);
}

const { toBase85 } = await moduleOf('core/base85.ts');

// The library's mechanics, compiled from web/core (see there), packed for its way.
const core = () => toBase85(gzipSync(readFileSync(join(source, '..', 'core', 'hydrapod.wasm')), { level: 9, memLevel: 7 }));

// The licences ask that their notices stay with what is passed on.
function notices() {
  const texts = ['three', 'uplot'].map((name) => {
    const { version } = JSON.parse(readFileSync(join(modules, name, 'package.json'), 'utf8'));
    return `${name} ${version}\n\n${readFileSync(join(modules, name, 'LICENSE'), 'utf8').trim()}`;
  });
  texts.push(readFileSync(join(source, '..', 'core', 'NOTICES.txt'), 'utf8').trim());
  return `This file contains\n\n${texts.join('\n\n')}\n`.replaceAll('--', '- -');
}

const hash = (text) => `'sha256-${createHash('sha256').update(text, 'utf8').digest('base64')}'`;

function page(script, style) {
  const policy = [
    "default-src 'none'",
    `script-src ${hash(script)} 'wasm-unsafe-eval'`,
    'worker-src blob:',
    `style-src ${hash(style)}`,
    'img-src data: blob:',
    "base-uri 'none'",
    "form-action 'none'",
  ].join('; ').concat('{{hydrapod-policy}}');
  const parts = { policy, script, style, core: core(), notices: notices() };
  return readFileSync(join(source, 'page.html'), 'utf8').replace(
    /<!--put (\w+)-->|put-(policy)/g,
    (_, part, attribute) => parts[part ?? attribute],
  );
}

// A C++ file with the page as string literals, short enough for every compiler.
function cpp(text) {
  const lines = text.match(/[^]{1,4000}/g).map((piece) => `    R"page(${piece})page"`);
  if (text.includes(')page"')) throw new Error('the page holds the end of a raw string');
  return [
    '// Written by web/build.mjs.',
    '#include "page.hpp"',
    'namespace hydrapod::report {',
    'namespace {',
    'constexpr char page[] =',
    `${lines.join('\n')};`,
    '}',
    'std::string_view page_template() { return {page, sizeof page - 1}; }',
    'std::string_view why_no_page() { return {}; }',
    '}  // namespace hydrapod::report',
    '',
  ].join('\n');
}

const output = process.argv[2];
if (!output) throw new Error('usage: node build.mjs OUTPUT.html|OUTPUT.cpp');
const [script, style] = await Promise.all([bundle('main.ts', [worker, shaders]), bundle('style/main.css')]);
const html = page(script.trim(), style.trim());
writeFileSync(output, output.endsWith('.cpp') ? cpp(html) : html);
