//! `sortie evaluate`: the objective for optimisers outside of this program.

use std::io::{self, BufRead, Read, Write};
use std::sync::mpsc::{self, Sender};
use std::thread;

use rayon::prelude::*;

use super::args;
use super::console::out;
use super::failure::Failure;
use crate::optimize::Problem;
use crate::path::Flight;
use crate::plan::{Request, objective, plan_fleet};
use crate::spec::{Document, MissionSpec};
use crate::study::Arena;
use crate::world::{self, World};

/// Bytes that are read at once.
const CHUNK: usize = 1 << 20;
/// Candidates of one parallel task.
const ROWS: usize = 64;

pub(super) fn run(arguments: &args::Evaluate) -> Result<(), Failure> {
    let (spec, world) = match Document::read(&arguments.spec)? {
        Document::Mission(file) => {
            let world = world::load(&file)?;
            (file.spec, world)
        }
        Document::Scenario(scenario) => {
            let arena = Arena::of(*scenario);
            (arena.spec, arena.world)
        }
    };
    let known = || {
        let ids: Vec<&str> = spec.vehicles.iter().map(|one| one.id.as_str()).collect();
        ids.join(", ")
    };
    let vehicle = spec
        .vehicles
        .iter()
        .position(|one| one.id == arguments.vehicle)
        .ok_or_else(|| {
            let id = &arguments.vehicle;
            Failure::new(
                Failure::USAGE,
                format!("no vehicle {id} (there are: {})", known()),
            )
        })?;
    let dimension = 3 * spec.planner.control_points;
    if arguments.dimension {
        return out(&dimension.to_string());
    }
    let earlier = flights_before(&spec, &world, vehicle);
    let samples = arguments.samples.unwrap_or(spec.planner.samples);
    let problem = objective(&spec, &world, vehicle, &earlier, samples);
    let input = io::stdin().lock();
    answering(io::stdout(), |answers| {
        if arguments.binary {
            binary(&problem, input, answers)
        } else {
            text(&problem, input, answers)
        }
    })
}

/// Writes answers in a thread of their own, while `act` reads on: one who sends all before
/// reading would else wait for us as we wait for it. What is not yet read is kept, a few
/// bytes for each candidate.
fn answering(
    mut output: impl Write + Send,
    act: impl FnOnce(&Answers) -> Result<(), Failure>,
) -> Result<(), Failure> {
    thread::scope(|scope| {
        let (sender, answers) = mpsc::channel::<Vec<u8>>();
        let writer = scope.spawn(move || {
            answers.into_iter().try_for_each(|answer| {
                output
                    .write_all(&answer)
                    .and_then(|()| output.flush())
                    .map_err(unwritable)
            })
        });
        let done = act(&Answers(sender));
        let written = writer.join().unwrap_or_else(|_| {
            Err(Failure::new(
                Failure::OUTPUT,
                "the writer of stdout panicked",
            ))
        });
        // Why no more could be written is known to the writer alone.
        written.and(done)
    })
}

/// Where answers go.
struct Answers(Sender<Vec<u8>>);

impl Answers {
    /// An error only if the writer has failed.
    fn send(&self, answer: Vec<u8>) -> Result<(), Failure> {
        let closed = |_| unwritable(io::ErrorKind::BrokenPipe.into());
        self.0.send(answer).map_err(closed)
    }
}

/// The whole flights of the vehicles before this one, planned as `plan` plans first.
fn flights_before(spec: &MissionSpec, world: &World, vehicle: usize) -> Vec<Flight> {
    let mut before = spec.clone();
    before.vehicles.truncate(vehicle);
    let request = Request {
        seed: spec.planner.seed,
        margins: Vec::new(),
        extra_parameters: Vec::new(),
        progress: &|_| (),
    };
    plan_fleet(&before, world, &request).flights(&before, world)
}

/// Costs of rows, in order, on all threads.
fn costs(problem: &impl Problem, rows: &[f64]) -> Vec<f64> {
    let dimension = problem.dimension();
    let mut costs = vec![0.0; rows.len() / dimension];
    rows.par_chunks(ROWS * dimension)
        .zip(costs.par_chunks_mut(ROWS))
        .for_each(|(rows, costs)| problem.evaluate(rows, f64::INFINITY, costs));
    costs
}

/// Answers all rows that have come in whole, as soon as they have.
fn binary(problem: &impl Problem, mut input: impl Read, answers: &Answers) -> Result<(), Failure> {
    let row_bytes = 8 * problem.dimension();
    let mut bytes = vec![0; CHUNK.max(row_bytes)];
    let (mut held, mut done) = (0, 0);
    loop {
        let came = input.read(&mut bytes[held..]).map_err(unreadable)?;
        held += came;
        let whole = held - held % row_bytes;
        let rows: Vec<f64> = bytes[..whole]
            .chunks_exact(8)
            .map(|eight| f64::from_le_bytes(std::array::from_fn(|i| eight[i])))
            .collect();
        check(&rows, problem.dimension(), done)?;
        done += rows.len() / problem.dimension();
        let answer: Vec<u8> = costs(problem, &rows)
            .iter()
            .flat_map(|cost| cost.to_le_bytes())
            .collect();
        answers.send(answer)?;
        bytes.copy_within(whole..held, 0);
        held -= whole;
        if came == 0 {
            return if held == 0 {
                Ok(())
            } else {
                let message = format!("the input ends within row {}", done + 1);
                Err(Failure::new(Failure::INPUT, message))
            };
        }
    }
}

/// Answers all lines that have come in whole, as soon as they have.
fn text(problem: &impl Problem, input: impl Read, answers: &Answers) -> Result<(), Failure> {
    let mut input = io::BufReader::with_capacity(CHUNK, input);
    let (mut rows, mut done) = (Vec::new(), 0);
    let mut line = Vec::new();
    loop {
        line.clear();
        let came = input.read_until(b'\n', &mut line).map_err(unreadable)?;
        if came > 0 {
            parse(
                &line,
                done + rows.len() / problem.dimension() + 1,
                problem.dimension(),
                &mut rows,
            )?;
        }
        // More lines are at hand: they belong to the same batch.
        if came > 0 && input.buffer().contains(&b'\n') {
            continue;
        }
        check(&rows, problem.dimension(), done)?;
        done += rows.len() / problem.dimension();
        let mut answer = String::new();
        for cost in costs(problem, &rows) {
            answer.push_str(&cost.to_string());
            answer.push('\n');
        }
        rows.clear();
        answers.send(answer.into_bytes())?;
        if came == 0 {
            return Ok(());
        }
    }
}

/// The numbers of a line, apart by blanks or commas; an empty line has none.
fn parse(line: &[u8], number: usize, dimension: usize, rows: &mut Vec<f64>) -> Result<(), Failure> {
    let bad = |what: String| Failure::new(Failure::INPUT, format!("row {number}: {what}"));
    let line = std::str::from_utf8(line).map_err(|error| bad(error.to_string()))?;
    let before = rows.len();
    for word in line
        .split([',', ' ', '\t', '\r', '\n'])
        .filter(|word| !word.is_empty())
    {
        rows.push(
            word.parse()
                .map_err(|_| bad(format!("{word} is no number")))?,
        );
    }
    match rows.len() - before {
        0 => Ok(()),
        found if found == dimension => Ok(()),
        found => Err(bad(format!("{found} numbers (allowed: {dimension})"))),
    }
}

/// No number may be infinite or none.
fn check(rows: &[f64], dimension: usize, done: usize) -> Result<(), Failure> {
    match rows.iter().position(|value| !value.is_finite()) {
        None => Ok(()),
        Some(at) => {
            let (row, number) = (done + at / dimension + 1, at % dimension + 1);
            let message = format!(
                "row {row}: number {number} is {} (allowed: finite)",
                rows[at]
            );
            Err(Failure::new(Failure::INPUT, message))
        }
    }
}

fn unwritable(error: io::Error) -> Failure {
    Failure::new(Failure::OUTPUT, format!("stdout: {error}"))
}

fn unreadable(error: io::Error) -> Failure {
    Failure::new(Failure::INPUT, format!("stdin: {error}"))
}
