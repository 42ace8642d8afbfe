// Makes modules small, and nothing else: joins them, leaves out comments and space, and shortens every name that is neither the language's nor
// public. For code in the style of this package: statements end with semicolons, there are no regular expressions, no templates within templates,
// and no names in strings.

const TOKEN = /\/\/[^\n]*|\/\*[^]*?\*\/|"(?:\\.|[^"\\])*"|'(?:\\.|[^'\\])*'|`(?:\\.|[^`\\])*`|[A-Za-z_$][\w$]*|\d[\w.]*|\s+|=>|\.\.\.|\?\.|\+\+|--|./g;
const IS_NAME = /^[A-Za-z_$]/;
/** Of the language, and of its iterators. */
const KEYWORDS =
  "arguments as async await break case catch class const constructor continue default delete do else export extends finally for from function get if " +
  "import in instanceof let new null of return set static super switch this throw true false try typeof var void while with yield done next value";

/** Modules as one script: lines that import are left out, and nothing is exported. */
export function joined(modules) {
  const plain = (text) => text.replace(/^import .*\n/gm, "").replace(/^export (?=class|const|function|async)/gm, "").replace(/^export \{.*\n/gm, "");
  return modules.map(plain).join("\n");
}

/** The names of the language, and of all that it brings along. */
function builtIn() {
  const names = new Set(KEYWORDS.split(" "));
  for (const name of Object.getOwnPropertyNames(globalThis)) {
    names.add(name);
    // Some of what Node brings along warns or fails when it is looked at.
    const { value, get } = Object.getOwnPropertyDescriptor(globalThis, name);
    const known = value ?? (/^[A-Z]/.test(name) && get ? globalThis[name] : null);
    for (const object of [known, known?.prototype]) {
      if (object === null || (typeof object !== "object" && typeof object !== "function") || object === globalThis) continue;
      Object.getOwnPropertyNames(object).forEach((own) => names.add(own));
    }
  }
  return names;
}

/** The words of a text, such as declarations. */
export function words(text) {
  return text.match(/[A-Za-z_$][\w$]*/g) ?? [];
}

function tokens(text) {
  return [...text.matchAll(TOKEN)].map(([token]) => token).filter((token) => !/^\s|^\/\/|^\/\*/.test(token));
}

/** A template with its code changed. */
function inTemplate(token, change) {
  return token.replace(/\$\{([^}]*)\}/g, (_, code) => "${" + change(code) + "}");
}

function* shortNames(taken) {
  const letters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ";
  for (let n = 0; ; n++) {
    const name = n < letters.length ? letters[n] : letters[Math.floor(n / letters.length) - 1] + letters[n % letters.length];
    if (!taken.has(name)) yield name;
  }
}

/** Calls `visit` with each token that is a name, those in templates included, and with its neighbours. */
function forEachName(list, visit) {
  list.forEach((token, i) => {
    if (token.startsWith("`")) inTemplate(token, (code) => (forEachName(tokens(code), visit), code));
    else if (IS_NAME.test(token)) visit(token, list[i - 1] ?? "", list[i + 1] ?? "");
  });
}

/** The statements that are in no other, each a list of tokens. */
function statements(list) {
  const all = [[]];
  let depth = 0;
  for (const token of list) {
    all.at(-1).push(token);
    depth += Number("([{".includes(token)) - Number(")]}".includes(token));
    if (depth === 0 && (token === ";" || token === "}")) all.push([]);
  }
  return all;
}

/** The same script in fewer bytes. Names in `open` stay. */
export function minified(text, open) {
  const all = statements(shorter(tokens(text)));
  const kept = new Set([...builtIn(), ...open]);
  const taken = new Set(kept);
  // How often each name is used, by which statements, and whether it may be that of a property.
  const uses = new Map();
  const properties = new Set();
  all.forEach((list, statement) =>
    forEachName(list, (name, before, after) => {
      taken.add(name);
      if (kept.has(name) || name.length === 1) return;
      if (!uses.has(name)) uses.set(name, { count: 0, by: new Set() });
      uses.get(name).count += 1;
      uses.get(name).by.add(statement);
      const isKey = "{,".includes(before) && [",", "}", "=", ":", "("].includes(after);
      if (before === "." || before === "?." || after === ":" || isKey || (after === "(" && "};".includes(before))) properties.add(name);
    }),
  );
  const ofAll = shortNames(taken);
  const short = new Map();
  const isLocal = (name) => uses.get(name).by.size === 1 && !properties.has(name);
  const byUse = [...uses.keys()].sort((a, b) => uses.get(b).count - uses.get(a).count);
  for (const name of byUse) if (!isLocal(name)) short.set(name, ofAll.next().value);
  // Names of one statement alone may be those of another as well.
  const apart = all.map((list) => {
    const own = new Set(kept);
    forEachName(list, (name) => own.add(short.get(name) ?? name));
    return { own: shortNames(own), names: new Map() };
  });
  for (const name of byUse) {
    if (!isLocal(name)) continue;
    const { own, names } = apart[[...uses.get(name).by][0]];
    names.set(name, own.next().value);
  }
  const written = (list, names) => {
    let out = "";
    for (const token of list) {
      const plain = names.get(token) ?? short.get(token) ?? token;
      const next = token.startsWith("`") ? inTemplate(token, (code) => written(tokens(code), names)) : plain;
      const [last, first] = [out.at(-1) ?? "", next[0]];
      const isApart = (/[\w$]/.test(last) && /[\w$]/.test(first)) || (last === first && "+-".includes(last));
      out += isApart ? ` ${next}` : next;
    }
    return out;
  };
  return all.map((list, statement) => written(list, apart[statement].names)).join("\n");
}

/** What means the same: `let` for `const`, a parameter without brackets, and no semicolon at the end of a block. */
function shorter(list) {
  const isSingle = (i) => list[i] === "(" && IS_NAME.test(list[i + 1]) && list[i + 2] === ")" && list[i + 3] === "=>" && list[i - 1] !== "async";
  return list.flatMap((token, i) => {
    if (isSingle(i) || isSingle(i - 2) || (token === ";" && list[i + 1] === "}")) return [];
    return token === "const" ? ["let"] : [token];
  });
}
