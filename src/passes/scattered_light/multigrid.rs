//! Light that diffuses through a [`LightNetwork`](crate::passes::light_network::LightNetwork), by multigrid: see `shaders/diffusion.wgsl`.

use crate::gpu::{Gpu, GpuError, Grid, Invocations, Kernel, KernelDescriptor, binding};
use crate::passes::light_network::Level;
use crate::report::Report;

/// The steps of multigrid.
#[derive(Debug)]
pub(super) struct Multigrid {
    gather_power: Kernel,
    gather_surplus: Kernel,
    interpolate: Kernel,
    correct: Kernel,
    begin: Kernel,
    relax: Kernel,
    finish: Kernel,
}

/// Steps on a level before it is corrected and after.
const STEPS_BEFORE: usize = 1;
const STEPS_AFTER: usize = 2;

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

/// What is looked for on a level, from its power.
struct Search {
    power: Grid,
    /// One is read while the other is written.
    fluence: [Grid; 2],
    current: usize,
}

impl Search {
    fn new(gpu: &Gpu, level: &Level, power: Grid) -> Result<Self, GpuError> {
        let grid = || Grid::new(gpu, "diffusion", level.shape.cells, FORMAT);
        Ok(Self { power, fluence: [grid()?, grid()?], current: 0 })
    }

    fn found(&self) -> &Grid {
        &self.fluence[self.current]
    }

    fn next(&self) -> &Grid {
        &self.fluence[1 - self.current]
    }
}

/// All that goes into one command encoder.
struct Solver<'a> {
    gpu: &'a Gpu,
    kernels: &'a Multigrid,
    levels: &'a [Level],
    encoder: &'a mut wgpu::CommandEncoder,
}

fn view(grid: &Grid) -> wgpu::BindingResource<'_> {
    wgpu::BindingResource::TextureView(&grid.view)
}

impl Multigrid {
    pub fn new(gpu: &Gpu, report: &mut Report) -> Result<Self, GpuError> {
        let read = binding::texture(wgpu::TextureViewDimension::D3, false);
        let write = binding::grid_out(FORMAT);
        let mut make = |entry_point, third, bindings: usize| {
            report.pipelines.push("diffusion");
            let all = [binding::UNIFORM, read, read, third, read, read, read, write];
            let bindings = &all[..bindings];
            Kernel::new(gpu, &KernelDescriptor { name: "diffusion", generated: &[], entry_point, bindings })
        };
        Ok(Self {
            gather_power: make("gather_power", read, 8)?,
            gather_surplus: make("gather_surplus", read, 8)?,
            interpolate: make("interpolate", read, 8)?,
            correct: make("correct", read, 8)?,
            begin: make("begin", read, 8)?,
            relax: make("relax", read, 8)?,
            finish: make("finish", binding::STORAGE_OUT, 7)?,
        })
    }

    /// Finds the fluence of each cell from the power of the cells of the finest level.
    pub fn solve(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        levels: &[Level],
        power: Grid,
        scattered: &wgpu::Buffer,
    ) -> Result<(), GpuError> {
        let search =
            |level: &Level| Search::new(gpu, level, Grid::new(gpu, "power", level.shape.cells, FORMAT)?);
        let mut searches = vec![Search::new(gpu, &levels[0], power)?];
        searches.extend(levels[1..].iter().map(search).collect::<Result<Vec<_>, _>>()?);
        let mut corrections: Vec<_> = levels.iter().map(search).collect::<Result<_, _>>()?;
        let mut solver = Solver { gpu, kernels: self, levels, encoder };
        for level in 0..levels.len() - 1 {
            let [fine, coarse] = [&searches[level].power, &searches[level + 1].power];
            solver.gather(&self.gather_power, level, [fine, fine], coarse);
        }
        let top = levels.len() - 1;
        solver.begin(top, &mut searches[top]);
        for level in (0..top).rev() {
            let (fine, coarse) = searches.split_at_mut(level + 1);
            solver.step(&self.interpolate, level, coarse[0].found(), &mut fine[level]);
            for _ in 0..STEPS_BEFORE {
                solver.relax(level, &mut fine[level]);
            }
            solver.cycle(level, &mut fine[level], &mut corrections[level + 1..]);
        }
        solver.finish(&searches, &corrections, scattered);
        Ok(())
    }
}

impl Solver<'_> {
    /// One kernel on a level, or on the cells of the coarser one.
    fn run(&mut self, kernel: &Kernel, level: usize, [power, fluence, out]: [&Grid; 3], count: u32) {
        let Level { uniform, sinks, links: [x, y, z], .. } = &self.levels[level];
        let mut resources = vec![uniform.as_entire_binding()];
        resources.extend([sinks, x, y, z, power, fluence, out].map(view));
        kernel.run(self.gpu, self.encoder, &resources, Invocations::Count(count), None);
    }

    /// From a level to the coarser one.
    fn gather(&mut self, kernel: &Kernel, level: usize, [power, fluence]: [&Grid; 2], coarse: &Grid) {
        let count = self.levels[level + 1].shape.count();
        self.run(kernel, level, [power, fluence, coarse], count);
    }

    /// Whatever brings a search further, from its power or from what a coarser level knows.
    fn step(&mut self, kernel: &Kernel, level: usize, from: &Grid, search: &mut Search) {
        let count = self.levels[level].shape.count();
        self.run(kernel, level, [from, search.found(), search.next()], count);
        search.current = 1 - search.current;
    }

    fn relax(&mut self, level: usize, search: &mut Search) {
        let count = self.levels[level].shape.count();
        self.run(&self.kernels.relax, level, [&search.power, search.found(), search.next()], count);
        search.current = 1 - search.current;
    }

    /// The first step, from nothing.
    fn begin(&mut self, level: usize, search: &mut Search) {
        let count = self.levels[level].shape.count();
        self.run(&self.kernels.begin, level, [&search.power, search.found(), search.next()], count);
        search.current = 1 - search.current;
    }

    /// Corrects a level by the coarser ones, of which `corrections` are the searches.
    fn cycle(&mut self, level: usize, search: &mut Search, corrections: &mut [Search]) {
        if let Some((coarse, coarser)) = corrections.split_first_mut() {
            let own = [&search.power, search.found()];
            self.gather(&self.kernels.gather_surplus, level, own, &coarse.power);
            self.begin(level + 1, coarse);
            self.cycle(level + 1, coarse, coarser);
            self.step(&self.kernels.correct, level, coarse.found(), search);
            for _ in 0..STEPS_AFTER {
                self.relax(level, search);
            }
        }
    }

    fn finish(&mut self, searches: &[Search], corrections: &[Search], scattered: &wgpu::Buffer) {
        let top = self.levels.len() - 1;
        for level in 0..top {
            let coarse = &corrections[level + 1].power;
            if level == 0 {
                let own = [&searches[0].power, searches[0].found()];
                self.gather(&self.kernels.gather_surplus, level, own, coarse);
            } else {
                let own = &corrections[level].power;
                self.gather(&self.kernels.gather_power, level, [own, own], coarse);
            }
        }
        let level = &self.levels[0];
        let (power, surplus) = (&searches[top].power, &corrections[top].power);
        let found = searches[0].found();
        let resources = [
            level.uniform.as_entire_binding(),
            view(power),
            view(surplus),
            scattered.as_entire_binding(),
            view(found),
            view(found),
            view(found),
        ];
        let count = Invocations::Count(level.shape.count());
        self.kernels.finish.run(self.gpu, self.encoder, &resources, count, None);
    }
}
